// The adapter of yaml-cpp: its types and exceptions stay in this file.

#include "config/yaml.hpp"

#include <cstddef>
#include <exception>
#include <fmt/format.h>
#include <optional>
#include <sstream>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

namespace scree::config {
namespace {

constexpr std::size_t kMaxBytes = 1 << 20;
constexpr int kMaxNodes = 100'000;
constexpr int kMaxDepth = 32;

/// Copies a yaml-cpp node; aliases are expanded, hence the budget.
class Copier {
 public:
  bool copy(const YAML::Node& from, YamlNode& to, int depth) {
    if (depth > kMaxDepth || --budget_ < 0) return false;
    to.line = from.Mark().line + 1;
    to.column = from.Mark().column + 1;
    if (from.IsScalar()) {
      to.kind = YamlNode::Kind::scalar;
      to.scalar = from.Scalar();
      to.quoted = from.Tag() == "!";
      return true;
    }
    if (from.IsSequence()) {
      to.kind = YamlNode::Kind::sequence;
      for (const auto& item : from) {
        if (!copy(item, to.items.emplace_back(), depth + 1)) return false;
      }
    } else if (from.IsMap()) {
      to.kind = YamlNode::Kind::map;
      for (const auto& entry : from) {
        if (!copy(entry.first, to.keys.emplace_back(), depth + 1)) return false;
        if (!copy(entry.second, to.items.emplace_back(), depth + 1)) return false;
      }
    }
    return true;
  }

 private:
  int budget_ = kMaxNodes;
};

/// Counts documents and builds nothing.
class DocumentCounter : public YAML::EventHandler {
 public:
  int count = 0;
  YAML::Mark last;  ///< where the last one begins

  void OnDocumentStart(const YAML::Mark& mark) override { ++count, last = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

/// Where a second document begins. Not by YAML::LoadAll, which makes documents without end, until no memory is left,
/// of some malformed texts (a single comma: github.com/jbeder/yaml-cpp/issues/1040).
std::optional<YAML::Mark> second_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentCounter counter;
  while (counter.count < 2 && parser.HandleNextDocument(counter)) {
  }
  return counter.count < 2 ? std::nullopt : std::optional(counter.last);
}

}  // namespace

Result<YamlNode> parse_yaml(std::string_view text, const std::string& name) {
  const auto fail = [&](int line, int column, std::string_view what) {
    return Error{ErrorKind::bad_data, fmt::format("{}:{}:{}: {}", name, line, column, what)};
  };
  if (text.size() > kMaxBytes)
    return fail(1, 1, fmt::format("expected at most {} bytes of YAML, found {}", kMaxBytes, text.size()));
  try {
    const std::string owned(text);
    if (const auto mark = second_document(owned))
      return fail(mark->line + 1, mark->column + 1, "expected one YAML document, found more behind it");
    YamlNode root;
    if (!Copier().copy(YAML::Load(owned), root, 0))
      return fail(1, 1, fmt::format("expected at most {} values in {} levels, found more", kMaxNodes, kMaxDepth));
    return root;
  } catch (const YAML::Exception& error) {
    return fail(error.mark.line + 1, error.mark.column + 1, "expected YAML, found a syntax error: " + error.msg);
  } catch (const std::exception& error) {
    return fail(1, 1, fmt::format("expected YAML, found something unreadable: {}", error.what()));
  }
}

std::string describe(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null:
      return "nothing";
    case YamlNode::Kind::scalar:
      if (node.scalar.size() > 60)
        return fmt::format("a text of {} characters that begins '{}'", node.scalar.size(), node.scalar.substr(0, 40));
      return node.quoted ? fmt::format("the text \"{}\"", node.scalar) : fmt::format("'{}'", node.scalar);
    case YamlNode::Kind::sequence:
      return fmt::format("a list of {}", node.items.size());
    case YamlNode::Kind::map:
      return "a map";
  }
  return "nothing";
}

}  // namespace scree::config
