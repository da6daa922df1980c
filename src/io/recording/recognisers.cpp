#include "recognisers.hpp"

namespace deltadyn {

Recording read_recording(const std::string& path, const std::string& topic) {
  if (const auto database = forms::rosbag2_database(path)) return forms::read_rosbag2(*database, topic);
  const forms::TextFile file = forms::read_text_file(path);
  std::optional<Recording> recording;
  for (const auto recogniser : {forms::read_twincat, forms::read_halscope}) {
    if (!recording) recording = recogniser(file);
  }
  // The special forms came first: delimited text takes everything
  if (!recording) recording = forms::read_delimited(file);
  if (file.is_windows_1252) recording->form += ", in Windows-1252";
  return *std::move(recording);
}

}  // namespace deltadyn
