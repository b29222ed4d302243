#pragma once
// A bench has nobody to hand an error to.

#include <cstdio>
#include <cstdlib>
#include <type_traits>
#include <utility>

#include "core/result.hpp"

namespace scree::bench {

[[noreturn]] inline void fail(const Error& error) {
  std::fprintf(stderr, "bench: %s\n", error.message.c_str());
  std::exit(static_cast<int>(error.kind));
}

/// The value, or the end of the program with the error's message.
template <class T>
T must(Result<T> result) {
  if (!result) fail(result.error());
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

}  // namespace scree::bench
