#include "config/recording_file.hpp"

#include <utility>

#include "config/key_types.hpp"
#include "config/sensor_schema.hpp"
#include "config/text_file.hpp"

namespace scree::config {
namespace {

/// recording.yaml as a whole; `version` is only checked.
struct Document {
  int version = 1;
  drivers::RecordingDescription recording;
};

Schema<Document> recording_schema() {
  Schema<Document> schema;
  schema.keys.push_back(integer<Document, int>(
      "scree_recording", [](Document& d) -> int& { return d.version; }, {1, 1, false}, "Version of the format."));
  schema.keys.back().expected = "1, the version of the format";
  schema.keys.back().required = true;
  schema.keys.push_back(choice<Document, drivers::Origin>(
      "origin", [](Document& d) -> drivers::Origin& { return d.recording.origin; },
      {{"live", drivers::Origin::live}, {"sim", drivers::Origin::sim}, {"hil", drivers::Origin::hil}},
      "What the frames were taken from."));
  append(schema, "sensor.",
         Lens<Document, SensorConfig>([](Document& d) -> SensorConfig& { return d.recording.sensor; }),
         sensor_schema(true));
  return schema;
}

}  // namespace

Result<drivers::RecordingDescription> parse_recording(std::string_view text, const std::string& name) {
  const auto root = parse_yaml(text, name);
  if (!root) return root.error();
  static const Schema<Document> schema = recording_schema();
  Document document;
  Given given;
  Faults faults;
  const auto keys = bind(schema, document);
  read_tree(*root, name, keys, given, faults);
  require_keys(*root, name, keys, given, faults);
  check_rules(schema, document, name, given, faults);
  if (!faults.empty()) return faults.to_error(ErrorKind::bad_data);
  normalise(document.recording.sensor.T_body_sensor);
  return std::move(document.recording);
}

Result<drivers::RecordingDescription> read_recording(const std::filesystem::path& directory) {
  const auto file = directory / "recording.yaml";
  const auto text = read_text_file(file, "the description of a recording");
  if (!text) return text.error();
  return parse_recording(*text, file.string());
}

std::string write_recording(const drivers::RecordingDescription& description) {
  return dump(recording_schema(), Document{1, description});
}

}  // namespace scree::config
