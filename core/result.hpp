#pragma once
// The one error mechanism of Scree: a value or an Error. Our code does not throw; exceptions of
// third-party libraries are caught in their adapter and become an Error.

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace scree {

/// What went wrong, as the process reports it: the values are the exit codes of the command line (sysexits.h).
enum class ErrorKind : int {
  usage = 64,          ///< the command line is wrong
  bad_data = 65,       ///< an input exists but is not what it should be
  no_input = 66,       ///< an input does not exist or cannot be opened
  unavailable = 69,    ///< a device or a port is not available
  internal = 70,       ///< a bug of ours
  cannot_create = 73,  ///< an output cannot be created
  io = 74,             ///< reading or writing failed half-way
  bad_config = 78,     ///< the configuration is wrong
};

/// `message` names the object, what was expected and what was found
/// (files: path and byte offset; config: file:line:column and key).
struct Error {
  ErrorKind kind = ErrorKind::internal;
  std::string message;
};

/// A T or an Error. Ask before you take: `if (!r) return r.error(); use(*r);`
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT(google-explicit-constructor)

  explicit operator bool() const { return state_.index() == 0; }
  T& operator*() & { return std::get<0>(state_); }
  const T& operator*() const& { return std::get<0>(state_); }
  T&& operator*() && { return std::get<0>(std::move(state_)); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }
  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success or an Error; default-constructed it is success.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  explicit operator bool() const { return !error_.has_value(); }
  const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};

using Status = Result<void>;

}  // namespace scree
