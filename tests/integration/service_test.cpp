// The node as a service of systemd: READY, the watchdog, STOPPING, told to a socket that stands in for systemd's; and a
// thread that really stands still, by ptrace.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>

#include "tests/integration/live_node.hpp"

namespace scree::test {
namespace {

using nlohmann::json;

/// What systemd would hear.
class Supervisor {
 public:
  explicit Supervisor(const std::filesystem::path& path) : path_(path.string()) {
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    path_.copy(at.sun_path, sizeof(at.sun_path) - 1);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&at), sizeof(at)), 0);
  }
  ~Supervisor() { close(socket_); }

  /// The next message within `limit`; empty = none.
  std::string next(milliseconds limit) {
    pollfd wait{socket_, POLLIN, 0};
    if (poll(&wait, 1, static_cast<int>(limit.count())) <= 0) return {};
    char text[4096];
    const ssize_t n = recv(socket_, text, sizeof(text), 0);
    return n > 0 ? std::string(text, static_cast<std::size_t>(n)) : std::string();
  }
  bool hears(const std::string& text, milliseconds limit) {
    const auto deadline = MonotonicClock::now() + limit;
    while (MonotonicClock::now() < deadline)
      if (next(milliseconds(100)).find(text) != std::string::npos) return true;
    return false;
  }
  /// Throws away what was said up to now.
  void forget() {
    while (!next(milliseconds(0)).empty()) {
    }
  }

 private:
  std::string path_;
  int socket_ = -1;
};

std::vector<std::string> with_environment(std::vector<std::string> variables, const std::vector<std::string>& words) {
  variables.insert(variables.begin(), "env");
  variables.insert(variables.end(), words.begin(), words.end());
  return variables;
}

/// The thread of that name; 0 when there is none.
pid_t thread_of(pid_t process, const std::string& name) {
  for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task"))
    if (read_file(task.path() / "comm") == name + "\n") return std::stoi(task.path().filename().string());
  return 0;
}

/// Stands still between construction and destruction.
class StoppedThread {
 public:
  explicit StoppedThread(pid_t thread) : thread_(thread) {
    stopped_ = ptrace(PTRACE_ATTACH, thread, nullptr, nullptr) == 0;
    if (stopped_) waitpid(thread, nullptr, __WALL);
  }
  ~StoppedThread() {
    if (stopped_) ptrace(PTRACE_DETACH, thread_, nullptr, nullptr);
  }
  bool stopped() const { return stopped_; }

 private:
  pid_t thread_;
  bool stopped_ = false;
};

class Service : public ::testing::Test {
 protected:
  Service() {
    write_file(folder_ / "robot.yaml", "source: {kind: stream, address: \"unix:" + (folder_ / "scanner").string() +
                                           "\", deadline_ms: 1000}\npose: {source: static}\n");
  }
  std::vector<std::string> node(const std::string& watchdog_us) {
    return with_environment({"NOTIFY_SOCKET=" + (folder_ / "notify").string(), "WATCHDOG_USEC=" + watchdog_us},
                            live(folder_ / "robot.yaml", ear_));
  }
  std::vector<std::string> scanner() const {
    return command({"simulate", "--terrain", "fbm:2.3,0.1,7,20,0.1", "--sensor", "depth", "--trajectory",
                    "line:-5,0,0,2,0.5", "--frame-period", "0.5", "--drive", "127.0.0.1:0", "--serve",
                    "unix:" + (folder_ / "scanner").string()});
  }

  TemporaryFolder folder_;
  Supervisor systemd_{folder_ / "notify"};
  Ear ear_;
};

TEST_F(Service, SaysThatItIsReadyThatItLivesHowItIsAndThatItStops) {
  Process process(node("4000000"));
  EXPECT_THAT(systemd_.next(seconds(120)), ::testing::StartsWith("READY=1\nSTATUS=acquiring from stream unix:"));
  EXPECT_TRUE(systemd_.hears("WATCHDOG=1", seconds(60))) << "also without a device: that is degraded, not dead";
  EXPECT_TRUE(systemd_.hears("STATUS=frames 0", seconds(60)));
  process.signal(SIGTERM);
  EXPECT_TRUE(systemd_.hears("STOPPING=1", seconds(60)));
  EXPECT_EQ(process.wait().exit_code, 0);
}

TEST_F(Service, WithoutAWatchdogNoneIsFedAndWithoutASocketNothingIsSaid) {
  Process process(with_environment(
      {"NOTIFY_SOCKET=" + (folder_ / "notify").string(), "WATCHDOG_USEC=4000000", "WATCHDOG_PID=1"},  // somebody else's
      live(folder_ / "robot.yaml", ear_)));
  EXPECT_TRUE(systemd_.hears("READY=1", seconds(120)));
  EXPECT_FALSE(systemd_.hears("WATCHDOG=1", seconds(3)));
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait().exit_code, 0);
}

// The watchdog's time is 2 s: a stage may stand still for 1 s, and what was fed before that is forgotten first.
class StageThatHangs : public Service, public ::testing::WithParamInterface<const char*> {};

TEST_P(StageThatHangs, StarvesTheWatchdogUntilItGoesOn) {
  Process device(scanner());
  Process process(node("2000000"));
  ASSERT_TRUE(ear_.until([&] { return ear_->frames_in() >= 2; })) << process.err();
  ASSERT_TRUE(systemd_.hears("WATCHDOG=1", seconds(60)));
  const pid_t thread = thread_of(process.pid(), GetParam());
  ASSERT_NE(thread, 0) << GetParam();
  {
    const StoppedThread stopped(thread);
    if (!stopped.stopped()) GTEST_SKIP() << "this system lets nobody stop a thread of a child";
    std::this_thread::sleep_for(seconds(4));  // two periods of the device, until a frame waits, and 1 s more
    systemd_.forget();
    EXPECT_FALSE(systemd_.hears("WATCHDOG=1", seconds(3)));
    EXPECT_THAT(process.err(), ::testing::HasSubstr("has not advanced for 1000 ms"));
  }
  EXPECT_TRUE(systemd_.hears("WATCHDOG=1", seconds(60))) << "it goes on";
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait().exit_code, 0) << process.err();
}

INSTANTIATE_TEST_SUITE_P(Stages, StageThatHangs,
                         ::testing::Values("scree-map", "scree-publish", "scree-receive", "scree-watch"));

// A source's thread that stands still inside its driver is left behind and another one takes over: the watchdog is fed
// on, and frames come again.
TEST_F(Service, ASourceThatHangsIsLeftBehindAndOpenedAgain) {
  Process device(scanner());
  Process process(node("8000000"));
  ASSERT_TRUE(ear_.until([&] { return ear_->frames_in() >= 2; })) << process.err();
  const pid_t thread = thread_of(process.pid(), "scree-source0");
  ASSERT_NE(thread, 0);
  const StoppedThread stopped(thread);
  if (!stopped.stopped()) GTEST_SKIP() << "this system lets nobody stop a thread of a child";
  ASSERT_TRUE(process.wait_for_text("it is left behind and opened again")) << process.err();
  const std::uint64_t frames = ear_->frames_in();
  EXPECT_TRUE(ear_.until([&] { return ear_->frames_in() >= frames + 2; })) << process.err();
  systemd_.forget();
  EXPECT_TRUE(systemd_.hears("WATCHDOG=1", seconds(60)));
  process.signal(SIGTERM);
  const auto finished = process.wait();
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_EQ(json::parse(finished.out)["sources"][0]["abandoned"], 1);
  EXPECT_THAT(finished.err, ::testing::HasSubstr("its thread is left behind"));
}

TEST(ServiceUnit, SystemdFindsNoFaultInIt) {
  if (run({"systemd-analyze", "--version"}).exit_code != 0) GTEST_SKIP() << "no systemd-analyze here";
  const TemporaryFolder folder;
  std::string unit = read_file(SCREE_SOURCE_DIR "/launch/scree.service");
  const std::string installed = "/usr/bin/scree";
  ASSERT_NE(unit.find(installed), std::string::npos);
  unit.replace(unit.find(installed), installed.size(), SCREE_BINARY);  // it checks that the program is there
  write_file(folder / "scree.service", unit);
  const auto verified = run({"systemd-analyze", "verify", "--man=no", (folder / "scree.service").string()});
  EXPECT_EQ(verified.exit_code, 0);
  EXPECT_EQ(verified.err, "") << "it warns of keys that it does not know";
}

}  // namespace
}  // namespace scree::test
