// What comes over the wire of usbredir: the library's callbacks.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>

#include "drivers/usbredir_port.hpp"

namespace scree::drivers {
namespace {

constexpr char kVersion[] = "scree";

UsbredirPort& port_of(void* its) {
  return *static_cast<UsbredirPort*>(its);
}

/// The library's convention: bytes moved, 0 = none now, −1 = the connection is gone.
int moved(UsbredirPort& port, StreamSocket::Moved what) {
  if (what.bytes > 0) return static_cast<int>(what.bytes);
  port.lost = port.lost || what.closed;
  return what.closed ? -1 : 0;
}

int read_from(void* its, std::uint8_t* data, int count) {
  UsbredirPort& port = port_of(its);
  return moved(port, port.socket->read({data, static_cast<std::size_t>(count)}, std::chrono::milliseconds(0)));
}

int write_to(void* its, std::uint8_t* data, int count) {
  UsbredirPort& port = port_of(its);
  return moved(port, port.socket->write({data, static_cast<std::size_t>(count)}));
}

void on_set_configuration(void* its, std::uint64_t id, usb_redir_set_configuration_header* asked) {
  UsbredirPort& port = port_of(its);
  const bool done = port.device.set_configuration(asked->configuration, port.sink());
  usb_redir_configuration_status_header reply{};
  reply.status = done ? usb_redir_success : usb_redir_stall;
  reply.configuration = port.device.configuration();
  usbredirparser_send_configuration_status(port.parser.get(), id, &reply);
}

void on_get_configuration(void* its, std::uint64_t id) {
  UsbredirPort& port = port_of(its);
  usb_redir_configuration_status_header reply{usb_redir_success, port.device.configuration()};
  usbredirparser_send_configuration_status(port.parser.get(), id, &reply);
}

void on_set_alternate(void* its, std::uint64_t id, usb_redir_set_alt_setting_header* asked) {
  UsbredirPort& port = port_of(its);
  const bool done = port.device.set_alternate(asked->interface, asked->alt, port.sink());
  usb_redir_alt_setting_status_header reply{};
  reply.status = done ? usb_redir_success : usb_redir_stall;
  reply.interface = asked->interface;
  usbredirparser_send_alt_setting_status(port.parser.get(), id, &reply);
}

void on_get_alternate(void* its, std::uint64_t id, usb_redir_get_alt_setting_header* asked) {
  UsbredirPort& port = port_of(its);
  usb_redir_alt_setting_status_header reply{};
  reply.status = port.device.has_interface(asked->interface) ? usb_redir_success : usb_redir_stall;
  reply.interface = asked->interface;
  usbredirparser_send_alt_setting_status(port.parser.get(), id, &reply);
}

void on_control(void* its, std::uint64_t id, usb_redir_control_packet_header* header, std::uint8_t* data, int size) {
  UsbredirPort& port = port_of(its);
  port.answer_control(id, *header, {data, static_cast<std::size_t>(std::max(size, 0))});
  usbredirparser_free_packet_data(port.parser.get(), data);
}

void on_bulk(void* its, std::uint64_t id, usb_redir_bulk_packet_header* header, std::uint8_t* data, int) {
  UsbredirPort& port = port_of(its);
  const std::size_t bytes = header->length | static_cast<std::size_t>(header->length_high) << 16;
  port.device.ask(header->endpoint, id, bytes, port.sink());
  usbredirparser_free_packet_data(port.parser.get(), data);
}

/// The rest of the protocol: this device has neither isochronous nor interrupt endpoints nor bulk streams, and offers
/// no buffered bulk input, so that a good host asks for none of it. Filters do not concern a device.
void refuse_the_rest(usbredirparser& parser) {
  parser.start_iso_stream_func = [](void* its, std::uint64_t id, usb_redir_start_iso_stream_header* asked) {
    usb_redir_iso_stream_status_header reply{usb_redir_inval, asked->endpoint};
    usbredirparser_send_iso_stream_status(port_of(its).parser.get(), id, &reply);
  };
  parser.stop_iso_stream_func = [](void*, std::uint64_t, usb_redir_stop_iso_stream_header*) {};
  parser.start_interrupt_receiving_func = [](void* its, std::uint64_t id,
                                             usb_redir_start_interrupt_receiving_header* asked) {
    usb_redir_interrupt_receiving_status_header reply{usb_redir_inval, asked->endpoint};
    usbredirparser_send_interrupt_receiving_status(port_of(its).parser.get(), id, &reply);
  };
  parser.stop_interrupt_receiving_func = [](void*, std::uint64_t, usb_redir_stop_interrupt_receiving_header*) {};
  parser.iso_packet_func = [](void* its, std::uint64_t, usb_redir_iso_packet_header*, std::uint8_t* data, int) {
    usbredirparser_free_packet_data(port_of(its).parser.get(), data);
  };
  parser.interrupt_packet_func = [](void* its, std::uint64_t, usb_redir_interrupt_packet_header*, std::uint8_t* data,
                                    int) { usbredirparser_free_packet_data(port_of(its).parser.get(), data); };
  parser.alloc_bulk_streams_func = [](void*, std::uint64_t, usb_redir_alloc_bulk_streams_header*) {};
  parser.free_bulk_streams_func = [](void*, std::uint64_t, usb_redir_free_bulk_streams_header*) {};
  parser.start_bulk_receiving_func = [](void*, std::uint64_t, usb_redir_start_bulk_receiving_header*) {};
  parser.stop_bulk_receiving_func = [](void*, std::uint64_t, usb_redir_stop_bulk_receiving_header*) {};
  parser.filter_reject_func = [](void*) {};
  parser.filter_filter_func = [](void*, usbredirfilter_rule* rules, int) { std::free(rules); };
  parser.device_disconnect_ack_func = [](void*) {};
}

void set_callbacks(usbredirparser& parser, UsbredirPort& port) {
  parser.priv = &port;
  parser.log_func = [](void*, int, const char*) {};
  parser.read_func = read_from;
  parser.write_func = write_to;
  parser.hello_func = [](void* its, usb_redir_hello_header*) { port_of(its).greeted = true; };
  parser.reset_func = [](void* its) { port_of(its).device.reset(port_of(its).sink()); };
  parser.set_configuration_func = on_set_configuration;
  parser.get_configuration_func = on_get_configuration;
  parser.set_alt_setting_func = on_set_alternate;
  parser.get_alt_setting_func = on_get_alternate;
  parser.control_packet_func = on_control;
  parser.bulk_packet_func = on_bulk;
  parser.cancel_data_packet_func = [](void* its, std::uint64_t id) {
    port_of(its).device.cancel(id, port_of(its).sink());
  };
  refuse_the_rest(parser);
}

}  // namespace

void UsbredirPort::open_parser() {
  parser.reset(usbredirparser_create());
  set_callbacks(*parser, *this);
  std::array<std::uint32_t, USB_REDIR_CAPS_SIZE> capabilities{};
  for (const int capability :
       {usb_redir_cap_connect_device_version, usb_redir_cap_device_disconnect_ack,
        usb_redir_cap_ep_info_max_packet_size, usb_redir_cap_64bits_ids, usb_redir_cap_32bits_bulk_length})
    usbredirparser_caps_set_cap(capabilities.data(), capability);
  usbredirparser_init(parser.get(), kVersion, capabilities.data(), USB_REDIR_CAPS_SIZE, usbredirparser_fl_usb_host);
}

}  // namespace scree::drivers
