// The simulated device at a usbredir port: this test is the other end, as QEMU is. Left out of builds without
// SCREE_WITH_USBREDIR.
#ifdef SCREE_WITH_USBREDIR

#include <cstdlib>
#include <gtest/gtest.h>
#include <thread>
#include <usbredirparser.h>

#include "drivers/simulated_usb_descriptors.hpp"
#include "drivers/stream_socket.hpp"
#include "drivers/usb_protocol.hpp"
#include "drivers/usbredir_server.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;
using Bytes = std::vector<std::uint8_t>;

/// The host's end of one connection.
struct Port {
  explicit Port(StreamSocket its) : socket(std::move(its)), parser(usbredirparser_create()) {
    parser->priv = this;
    parser->log_func = [](void*, int level, const char* text) {
      if (level <= usbredirparser_warning) ADD_FAILURE() << text;
    };
    parser->read_func = [](void* p, std::uint8_t* data, int count) {
      return self(p).moved(self(p).socket.read({data, static_cast<std::size_t>(count)}, milliseconds(0)));
    };
    parser->write_func = [](void* p, std::uint8_t* data, int count) {
      return self(p).moved(self(p).socket.write({data, static_cast<std::size_t>(count)}));
    };
    parser->hello_func = [](void*, usb_redir_hello_header*) {};
    parser->interface_info_func = [](void* p, usb_redir_interface_info_header* h) { self(p).interfaces = *h; };
    parser->ep_info_func = [](void* p, usb_redir_ep_info_header* h) { self(p).endpoints = *h; };
    parser->device_connect_func = [](void* p, usb_redir_device_connect_header* h) {
      ++self(p).arrivals;
      self(p).vendor = h->vendor_id;
    };
    parser->device_disconnect_func = [](void* p) { ++self(p).departures; };
    parser->configuration_status_func = [](void* p, std::uint64_t, usb_redir_configuration_status_header* h) {
      self(p).configuration = h->configuration;
    };
    parser->control_packet_func = [](void* p, std::uint64_t, usb_redir_control_packet_header* h, std::uint8_t* data,
                                     int size) {
      self(p).control_status = h->status;
      self(p).control.assign(data, data + size);
      usbredirparser_free_packet_data(self(p).parser, data);
    };
    parser->bulk_packet_func = [](void* p, std::uint64_t transfer, usb_redir_bulk_packet_header* h, std::uint8_t* data,
                                  int size) {
      self(p).bulk.push_back({transfer, h->status, Bytes(data, data + size)});
      usbredirparser_free_packet_data(self(p).parser, data);
    };
    std::uint32_t capabilities[USB_REDIR_CAPS_SIZE]{};
    for (const int c :
         {usb_redir_cap_connect_device_version, usb_redir_cap_device_disconnect_ack,
          usb_redir_cap_ep_info_max_packet_size, usb_redir_cap_64bits_ids, usb_redir_cap_32bits_bulk_length})
      usbredirparser_caps_set_cap(capabilities, c);
    usbredirparser_init(parser, "test", capabilities, USB_REDIR_CAPS_SIZE, 0);
  }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  ~Port() { usbredirparser_destroy(parser); }

  static Port& self(void* p) { return *static_cast<Port*>(p); }
  static int moved(StreamSocket::Moved what) {
    return what.bytes > 0 ? static_cast<int>(what.bytes) : what.closed ? -1 : 0;
  }
  void serve() {
    (void)usbredirparser_do_read(parser);
    (void)usbredirparser_do_write(parser);
  }
  void ask_control(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index,
                   std::uint16_t length) {
    const auto endpoint = static_cast<std::uint8_t>(type & 0x80);
    usb_redir_control_packet_header header{endpoint, request, type, 0, value, index, length};
    control_status = 255;
    usbredirparser_send_control_packet(parser, ++id, &header, nullptr, 0);
  }
  std::uint64_t ask_bulk(std::uint32_t bytes) {
    usb_redir_bulk_packet_header header{};
    header.endpoint = usb::kFrameEndpoint;
    header.length = static_cast<std::uint16_t>(bytes);
    header.length_high = static_cast<std::uint16_t>(bytes >> 16);
    usbredirparser_send_bulk_packet(parser, ++id, &header, nullptr, 0);
    return id;
  }

  struct Transfer {
    std::uint64_t id;
    int status;
    Bytes bytes;
  };
  StreamSocket socket;
  usbredirparser* parser;
  usb_redir_interface_info_header interfaces{};
  usb_redir_ep_info_header endpoints{};
  int arrivals = 0, departures = 0, vendor = 0, configuration = -1, control_status = 255;
  Bytes control;
  std::vector<Transfer> bulk;
  std::uint64_t id = 0;
};

class UsbredirTest : public ::testing::Test {
 protected:
  UsbredirTest() {
    auto listening = StreamSocket::listen_at(*parse_stream_address("unix:" + path(), "test"));
    EXPECT_TRUE(listening) << listening.error().message;
    listener = *std::move(listening);
    auto opened = UsbredirServer::open(path(), {"simulated depth", 60, 80, true, milliseconds(100), 10'000});
    EXPECT_TRUE(opened) << opened.error().message;
    server = *std::move(opened);
  }
  std::string path() const { return (folder / "usb").string(); }

  /// Serves both ends until `done`, 10 s at most.
  template <class Done>
  bool until(Done done) {
    for (const auto limit = MonotonicClock::now() + std::chrono::seconds(10); MonotonicClock::now() < limit;) {
      server->serve();
      if (auto came = listener->accept()) port = std::make_unique<Port>(*std::move(came));
      if (port) port->serve();
      if (done()) return true;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return false;
  }
  void plug_in_and_stream() {
    ASSERT_TRUE(until([&] { return port && port->arrivals == 1; }));
    usb_redir_set_configuration_header one{1};
    usbredirparser_send_set_configuration(port->parser, ++port->id, &one);
    port->ask_control(0x41, 2, 1, usb::kScannerInterface, 0);
    ASSERT_TRUE(until([&] { return port->control_status == usb_redir_success; }));
    EXPECT_EQ(port->configuration, 1);
    EXPECT_EQ(server->readers(), 1u);
  }
  static ServedFrame frame(std::size_t bytes) { return {std::make_shared<const Bytes>(bytes, 0x5C), nullptr, false}; }

  test::TemporaryFolder folder;
  std::optional<StreamSocket> listener;
  std::unique_ptr<FrameServer> server;
  std::unique_ptr<Port> port;
};

TEST_F(UsbredirTest, TheDeviceIsAnnouncedWithItsInterfacesAndEndpoints) {
  ASSERT_TRUE(until([&] { return port && port->arrivals == 1; }));
  EXPECT_EQ(port->vendor, usb::kVendorId);
  EXPECT_EQ(port->interfaces.interface_count, 3u);
  EXPECT_EQ(port->interfaces.interface_class[0], usb::kInterfaceClass);
  EXPECT_EQ(port->endpoints.type[17], usb_redir_type_bulk);
  EXPECT_EQ(port->endpoints.type[18], usb_redir_type_bulk);
  EXPECT_EQ(port->endpoints.type[19], usb_redir_type_invalid);
  EXPECT_EQ(port->endpoints.max_packet_size[17], usb::kBulkPacketBytes);
  port->ask_control(0x80, 6, 0x0100, 0, 64);
  ASSERT_TRUE(until([&] { return port->control_status == usb_redir_success; }));
  EXPECT_EQ(port->control.size(), 18u);
  port->ask_control(0x80, 6, 0x0F00, 0, 64);
  ASSERT_TRUE(until([&] { return port->control_status != 255; }));
  EXPECT_EQ(port->control_status, usb_redir_stall);
}

TEST_F(UsbredirTest, AFrameAnswersTheTransfersThatWait) {
  plug_in_and_stream();
  const auto first = port->ask_bulk(65'536), second = port->ask_bulk(65'536);
  until([n = 0]() mutable { return ++n > 20; });
  EXPECT_TRUE(port->bulk.empty());
  server->send(frame(70'000));
  ASSERT_TRUE(until([&] { return port->bulk.size() == 2; }));
  EXPECT_EQ(port->bulk[0].id, first);
  EXPECT_EQ(port->bulk[0].bytes.size(), 65'536u) << "more than 16 bits of length";
  EXPECT_EQ(port->bulk[1].id, second);
  EXPECT_EQ(port->bulk[1].bytes, Bytes(70'000 - 65'536, 0x5C));
  EXPECT_EQ(server->counters().sent, 1u);
}

TEST_F(UsbredirTest, FaultsHaveTheStatusOfTheProtocol) {
  plug_in_and_stream();
  server->stall();
  port->ask_bulk(512);
  ASSERT_TRUE(until([&] { return port->bulk.size() == 1; }));
  EXPECT_EQ(port->bulk[0].status, usb_redir_stall);
  port->ask_control(0x02, 1, 0, usb::kFrameEndpoint, 0);
  ASSERT_TRUE(until([&] { return port->control_status == usb_redir_success; }));
  server->babble();
  port->ask_bulk(512);
  ASSERT_TRUE(until([&] { return port->bulk.size() == 2; }));
  EXPECT_EQ(port->bulk[1].status, usb_redir_babble);
  const auto waiting = port->ask_bulk(512);
  usbredirparser_send_cancel_data_packet(port->parser, waiting);
  ASSERT_TRUE(until([&] { return port->bulk.size() == 3; }));
  EXPECT_EQ(port->bulk[2].status, usb_redir_cancelled);
}

TEST_F(UsbredirTest, UnpluggedItIsGoneAndComesBackOnTheSameConnection) {
  plug_in_and_stream();
  port->ask_bulk(512);
  server->set_link({.unplugged = true});
  ASSERT_TRUE(until([&] { return port->departures == 1; }));
  EXPECT_EQ(server->readers(), 0u);
  server->set_link({});
  ASSERT_TRUE(until([&] { return port->arrivals == 2; }));
  EXPECT_EQ(server->readers(), 0u) << "nobody has asked for frames since";
}

TEST_F(UsbredirTest, WhenTheOtherEndHasClosedItConnectsAgain) {
  plug_in_and_stream();
  port.reset();
  ASSERT_TRUE(until([&] { return port && port->arrivals == 1; }));
  EXPECT_EQ(server->readers(), 0u);
}

}  // namespace
}  // namespace scree::drivers

#endif
