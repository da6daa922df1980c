#include "deltadyn/io/output_file.hpp"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <iterator>
#include <unistd.h>
#include <utility>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

namespace fs = std::filesystem;

std::string remedy(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT: return "free some space or write to another disk";
    case EFBIG: return "raise the limit on the size of files or write to another disk";
    case EACCES:
    case EPERM:
    case EROFS: return "choose a folder you may write to";
    case ENOENT:
    case ENOTDIR: return "create the folder first, or correct the path";
    case EISDIR: return "give the name of a file, not of a folder";
    default: return "check the path and the disk";
  }
}

fs::path followed(const std::string& path) {
  std::error_code ignored;
  const fs::path resolved = fs::weakly_canonical(path, ignored);
  return ignored ? fs::path(path) : resolved;
}

}  // namespace

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
  if (path_.empty()) throw Error("the name of the output file is empty", "", "give a file name", ExitCode::usage);
  std::error_code ignored;
  const fs::file_status status = fs::status(path_, ignored);
  if (fs::is_directory(status)) fail("cannot write", EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    // Renaming over a device or a pipe would replace it.
    file_ = std::fopen(path_.c_str(), "wb");
    if (file_ == nullptr) fail("cannot open for writing", errno);
    return;
  }
  target_ = followed(path_).string();
  if (fs::exists(status) && ::access(target_.c_str(), W_OK) != 0) fail("cannot overwrite", errno);
  static std::atomic<unsigned> counter{0};
  for (;;) {
    temporary_ = fmt::format("{}.{}-{}.tmp", target_, ::getpid(), counter++);
    const int descriptor = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      file_ = ::fdopen(descriptor, "wb");
      if (file_ == nullptr) {
        const int error_number = errno;
        ::close(descriptor);
        fail("cannot open for writing", error_number);
      }
      break;
    }
    if (errno != EEXIST) {
      const int error_number = errno;
      temporary_.clear();  // it is not ours to remove
      fail("cannot create the file", error_number);
    }
  }
  if (fs::exists(status)) fs::permissions(temporary_, status.permissions(), ignored);
}

OutputFile::~OutputFile() {
  discard();
}

void OutputFile::discard() noexcept {
  if (file_ != nullptr) std::fclose(file_);
  file_ = nullptr;
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
}

void OutputFile::fail(const char* doing, int error_number) {
  discard();
  throw Error(fmt::format("{}: {}", doing, std::strerror(error_number)), path_, remedy(error_number));
}

void OutputFile::write(std::string_view bytes) {
  if (file_ == nullptr) throw Error("the file is already complete", path_, "", ExitCode::bad_input);
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail("cannot write", errno);
}

void OutputFile::commit() {
  if (file_ == nullptr) throw Error("the file is already complete", path_, "", ExitCode::bad_input);
  if (std::fflush(file_) != 0) fail("cannot write", errno);
  // Some file systems report a full disk only here. Devices and pipes do not know fsync.
  if (!temporary_.empty() && ::fsync(::fileno(file_)) != 0 && errno != EINVAL) fail("cannot write", errno);
  std::FILE* const closing = std::exchange(file_, nullptr);
  if (std::fclose(closing) != 0) fail("cannot write", errno);
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot rename the finished file", errno);
  temporary_.clear();
}

void write_file(const std::string& path, std::string_view bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

void write_table(const std::string& path, const std::string& header, const Eigen::VectorXd& t_s,
                 const std::vector<const Eigen::MatrixXd*>& blocks) {
  OutputFile file(path);
  file.write(header + "\n");
  for (Eigen::Index row = 0; row < t_s.size(); ++row) {
    std::string text = fmt::format("{}", t_s(row));
    for (const Eigen::MatrixXd* block : blocks) {
      for (Eigen::Index k = 0; k < block->cols(); ++k)
        fmt::format_to(std::back_inserter(text), ",{}", (*block)(row, k));
    }
    file.write(text + "\n");
  }
  file.commit();
}

void refuse_overwrite(const std::string& output, const std::vector<std::string>& inputs) {
  if (output.empty()) return;
  for (const std::string& input : inputs) {
    if (input.empty()) continue;
    std::error_code ignored;
    const bool same = fs::equivalent(output, input, ignored);
    if ((!ignored && same) || followed(output) == followed(input)) {
      throw Error(fmt::format("the output would overwrite the input file {}", input), output,
                  "give the output another name", ExitCode::usage);
    }
  }
}

}  // namespace deltadyn
