#pragma once
// What systemd wants to hear of a service of Type=notify: READY, STATUS, WATCHDOG, STOPPING (sd_notify(3)).

#include <optional>
#include <string>

#include "core/time.hpp"

namespace scree::node {

/// Datagrams to $NOTIFY_SOCKET; without it every call does nothing. Never blocks, never fails: a service goes on when
/// nobody listens.
class ServiceNotify {
 public:
  /// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  ServiceNotify();
  ~ServiceNotify();
  ServiceNotify(const ServiceNotify&) = delete;
  ServiceNotify& operator=(const ServiceNotify&) = delete;

  void ready(const std::string& status) const;
  void status(const std::string& status) const;
  void stopping() const;
  void feed_watchdog() const;

  /// The service is killed when it feeds no watchdog for this long; none = nobody watches.
  std::optional<Duration> watchdog() const { return watchdog_; }

 private:
  void send(const std::string& message) const;

  int socket_ = -1;
  std::string address_;  ///< as in the environment; '@' begins an abstract one
  std::optional<Duration> watchdog_;
};

}  // namespace scree::node
