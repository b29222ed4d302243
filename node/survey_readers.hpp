#pragma once
// The kinds of input behind read_survey, and the random choice that they share.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "core/random.hpp"
#include "core/result.hpp"
#include "node/survey_input.hpp"

namespace scree::node {

inline constexpr double kHalfUlp = 0x1p-24;  ///< of float32, relative

/// Lets through `most` of `total` offers, each set of that size being equally likely. Source: Knuth, algorithm S.
class Choice {
 public:
  Choice(std::size_t total, std::size_t most, std::uint64_t seed)
      : left_(total), wanted_(std::min(total, most)), seed_(seed) {}
  bool take() {
    constexpr std::uint64_t kStream = 0x7375727665792063;  // "survey c"
    const auto at = static_cast<std::uint64_t>(left_);
    const auto words =
        random_words(seed_, kStream, static_cast<std::int32_t>(at & 0xffffffffU), static_cast<std::int32_t>(at >> 32));
    const bool taken = to_uniform(words[0]) * static_cast<double>(left_--) < static_cast<double>(wanted_);
    if (taken) --wanted_;
    return taken;
  }

 private:
  std::size_t left_, wanted_;
  std::uint64_t seed_;
};

Result<SurveyInput> read_raster_survey(const std::filesystem::path& file, const SurveyReading& reading);
Result<SurveyInput> read_recording_survey(const std::filesystem::path& file, const SurveyReading& reading);

/// `survey.all` and `origin_m` are set; fills in the rest that follows from them.
void choose_points(SurveyInput& survey, const SurveyReading& reading);

}  // namespace scree::node
