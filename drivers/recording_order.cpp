// Several recordings replayed as the one stream that they were.

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <utility>

#include "drivers/recording.hpp"
#include "drivers/recording_source.hpp"
#include "drivers/table.hpp"

namespace scree::drivers {
namespace {

constexpr const char* kOrderFile = "order.csv";

struct Part {
  std::unique_ptr<Source> source;
  std::uint64_t next = 0;  ///< place of the frame that it will give next
};

class OrderedSource final : public Source {
 public:
  OrderedSource(std::string name, std::vector<OrderRow> order, std::map<std::string, Part> parts, ReplayWindow window,
                std::string remark)
      : name_(std::move(name)),
        order_(std::move(order)),
        parts_(std::move(parts)),
        window_(window),
        remark_(std::move(remark)) {}

  Result<SourceEvent> next(std::chrono::milliseconds timeout) override {
    if (!remark_.empty()) return SourceEvent{SourceEvent::Kind::notice, nullptr, std::exchange(remark_, {})};
    while (next_ < order_.size()) {
      const OrderRow& row = order_[next_];
      Part& part = parts_.at(row.recording);
      auto event = part.source->next(timeout);
      if (!event || event->kind == SourceEvent::Kind::notice) return event;
      if (event->kind == SourceEvent::Kind::end_of_stream || part.next > row.frame)
        return Error{ErrorKind::bad_data, fmt::format("{}/{}:{}: expected a frame that comes next in '{}', found {}",
                                                      name_, kOrderFile, next_ + 2, row.recording, row.frame)};
      if (part.next++ < row.frame) continue;  // mapped before the order was written: killed in between
      ++next_;
      if (event->kind == SourceEvent::Kind::skipped || within(*event->frame)) return event;
    }
    return SourceEvent{SourceEvent::Kind::end_of_stream, nullptr, {}};
  }

  Origin origin() const override { return Origin::replay; }
  std::string name() const override { return name_; }
  std::optional<std::size_t> frame_count() const override { return order_.size(); }

 private:
  bool within(const RangeFrame& frame) {
    if (!first_) first_ = frame.time;
    const Duration elapsed = frame.time - *first_;
    return elapsed >= window_.start && (!window_.duration || elapsed - window_.start < *window_.duration);
  }

  std::string name_;
  std::vector<OrderRow> order_;
  std::map<std::string, Part> parts_;
  ReplayWindow window_;
  std::string remark_;
  std::size_t next_ = 0;
  std::optional<Time> first_;
};

}  // namespace

bool has_ordered_recordings(const std::filesystem::path& directory) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(directory / kOrderFile, ignored);
}

Result<std::unique_ptr<Source>> open_ordered_recordings(const std::filesystem::path& directory,
                                                        const Describe& describe, ReplayWindow window,
                                                        RecordedPoses poses) {
  const auto text = read_table_text(directory / kOrderFile);
  if (!text) return text.error();
  std::string torn;
  auto order = parse_order_table(*text, (directory / kOrderFile).string(), &torn);
  if (!order) return order.error();
  std::map<std::string, Part> parts;
  for (const OrderRow& row : *order) {
    if (parts.contains(row.recording)) continue;
    auto description = describe(directory / row.recording);
    if (!description) return description.error();
    auto source = open_recording(directory / row.recording, *std::move(description), {}, poses);
    if (!source) return source.error();
    parts[row.recording].source = *std::move(source);
  }
  return std::unique_ptr<Source>(std::make_unique<OrderedSource>(directory.string(), *std::move(order),
                                                                 std::move(parts), window, std::move(torn)));
}

}  // namespace scree::drivers
