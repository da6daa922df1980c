#include "recognisers.hpp"

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

Recording read_recording(const std::string& path, const RecordingOptions& options) {
  if (const auto database = forms::rosbag2_database(path)) return forms::read_rosbag2(*database, options);
  const forms::TextFile file = forms::read_text_file(path);
  // The special forms first: delimited text takes everything.
  for (const auto recogniser : {forms::read_twincat, forms::read_halscope}) {
    if (auto recording = recogniser(file)) return *std::move(recording);
  }
  return forms::read_delimited(file);
}

}  // namespace deltadyn
