#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <utility>

#include "deltadyn/io/text_encoding.hpp"
#include "deltadyn/runtime/error.hpp"

#include "recognisers.hpp"

namespace deltadyn::forms {
namespace {

struct BinaryForm {
  std::string_view magic;
  const char* name;
  const char* mend;
};

using namespace std::string_view_literals;

/// The first bytes of the forms that people have in hand, and the shortest way from each to a text.
constexpr BinaryForm kBinaryForms[] = {
    {"PK\x03\x04"sv, "a zip archive, as Excel (.xlsx), LibreOffice (.ods) and zipped exports are",
     "open it in the spreadsheet and save it as CSV, or unzip it, and give that file"},
    {"\xD0\xCF\x11\xE0"sv, "an old Excel workbook (.xls)", "save it as CSV in the spreadsheet and give that file"},
    {"MATLAB 5.0 MAT-file"sv, "a MATLAB .mat file",
     "in MATLAB: writetable(array2table([t q tau]), 'log.csv') with names for the columns"},
    {"\x89HDF\r\n\x1a\n"sv, "an HDF5 file (also MATLAB .mat of version 7.3)",
     "in MATLAB: writetable(array2table([t q tau]), 'log.csv'); in Python: h5py and numpy.savetxt"},
    {"#ROSBAG V"sv, "a ROS 1 bag",
     "convert it: rostopic echo -b FILE.bag -p /joint_states > log.csv, or rosbags-convert to rosbag2"},
    {"\x89MCAP0\r\n"sv, "a rosbag2 in MCAP storage",
     "convert it to SQLite storage: ros2 bag convert -i FILE.mcap -o out.yaml with storage_id: sqlite3; or export CSV "
     "from PlotJuggler"},
    {"\x1f\x8b"sv, "a gzip archive", "gunzip it and give the file inside"},
    {"\x28\xB5\x2F\xFD"sv, "a zstd archive", "unzstd it and give the file inside"},
    {"BZh"sv, "a bzip2 archive", "bunzip2 it and give the file inside"},
    {"7z\xBC\xAF\x27\x1C"sv, "a 7z archive", "unpack it and give the file inside"},
    {"PAR1"sv, "a Parquet file", "in Python: pandas.read_parquet(FILE).to_csv('log.csv', index=False)"},
    {"\x93NUMPY"sv, "a NumPy array",
     "in Python: numpy.savetxt('log.csv', numpy.load(FILE), delimiter=',', header='t_s,q1_rad,...', comments='')"},
    {"TDSm"sv, "a LabVIEW TDMS file",
     "export it as CSV, in Python: nptdms.TdmsFile(FILE).as_dataframe().to_csv('log.csv')"},
    {"MDF     "sv, "an ASAM MDF measurement",
     "export it as CSV, in Python: asammdf.MDF(FILE).export('csv', 'log.csv')"},
    {"ULog"sv, "a PX4 ULog", "convert it: ulog2csv FILE"},
    {"<?xml"sv, "an XML document", "export the recording as CSV (TwinCAT Scope: File, Export, CSV)"},
    {"%PDF"sv, "a PDF", "give the recording itself, as CSV"},
};

}  // namespace

std::string read_bytes(const std::string& path, const char* instead_of_folder) {
  std::error_code failed;
  if (std::filesystem::is_directory(path, failed)) throw Error("this is a folder, not a file", path, instead_of_folder);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file)
    throw Error(fmt::format("cannot open the file: {}", std::strerror(errno)), path,
                "check the path and the permissions");
  std::string bytes;
  const auto size = std::filesystem::file_size(path, failed);
  if (!failed) bytes.reserve(size + 1);
  constexpr std::size_t kBlock = 1 << 20;
  for (;;) {
    const std::size_t before = bytes.size();
    bytes.resize(before + kBlock);
    const std::size_t got = std::fread(bytes.data() + before, 1, kBlock, file.get());
    bytes.resize(before + got);
    if (got < kBlock) break;
  }
  if (std::ferror(file.get()) != 0) {
    throw Error(fmt::format("cannot read the file: {}", std::strerror(errno)), path, "check the path and the disk");
  }
  return bytes;
}

void refuse_zero_bytes(const std::string& path, std::string_view text) {
  if (text.find('\0') != std::string_view::npos)
    throw Error("the file holds zero bytes, so it is not a text file", path, "export it as CSV in UTF-8 or ASCII");
}

void refuse_binary_form(const std::string& path, std::string_view head) {
  for (const BinaryForm& form : kBinaryForms) {
    if (head.starts_with(form.magic)) throw Error(fmt::format("this is {}", form.name), path, form.mend);
  }
}

TextFile read_text_file(const std::string& path) {
  TextFile file{path, read_bytes(path, "give the exported file, or the folder of a rosbag2 with its .db3 file")};
  if (file.text.empty()) throw Error("the file is empty", path, "check that the recording or its export is complete");
  refuse_binary_form(path, file.text);
  DecodedText decoded = decode_text(std::move(file.text));
  file.text = std::move(decoded.text);
  file.is_windows_1252 = decoded.is_windows_1252;
  refuse_zero_bytes(path, file.text);
  return file;
}

}  // namespace deltadyn::forms
