// What goes over the wire of usbredir: announcements and answers.

#include <algorithm>
#include <iterator>

#include "drivers/usb_protocol.hpp"
#include "drivers/usbredir_port.hpp"

namespace scree::drivers {
namespace {

constexpr std::uint8_t kVideoClass = 0x0E;

std::uint8_t wire_status(usb::TransferStatus status) {
  switch (status) {
    case usb::TransferStatus::success:
      return usb_redir_success;
    case usb::TransferStatus::cancelled:
      return usb_redir_cancelled;
    case usb::TransferStatus::invalid:
      return usb_redir_inval;
    case usb::TransferStatus::stall:
      return usb_redir_stall;
    case usb::TransferStatus::babble:
      return usb_redir_babble;
  }
  return usb_redir_ioerror;
}

/// Fills usbredir's tables of what a device consists of.
struct Tables {
  usb_redir_interface_info_header interfaces{};
  usb_redir_ep_info_header endpoints{};

  Tables() {
    std::fill(std::begin(endpoints.type), std::end(endpoints.type), std::uint8_t{usb_redir_type_invalid});
    add(0x00, usb_redir_type_control, 0, 64);
    add(0x80, usb_redir_type_control, 0, 64);
  }
  void add_interface(std::uint8_t number, std::uint8_t its_class, std::uint8_t subclass, std::uint8_t protocol) {
    const std::uint32_t i = interfaces.interface_count++;
    interfaces.interface[i] = number;
    interfaces.interface_class[i] = its_class;
    interfaces.interface_subclass[i] = subclass;
    interfaces.interface_protocol[i] = protocol;
  }
  /// The first half of the tables are the OUT endpoints.
  void add(std::uint8_t address, std::uint8_t type, std::uint8_t interface, std::uint16_t packet_bytes) {
    const auto i = static_cast<std::size_t>((address & 0x80) >> 3 | (address & 0x0F));
    endpoints.type[i] = type;
    endpoints.interface[i] = interface;
    endpoints.max_packet_size[i] = packet_bytes;
  }
};

}  // namespace

void UsbredirPort::announce() {
  Tables tables;
  tables.add_interface(usb::kScannerInterface, usb::kInterfaceClass, usb::kInterfaceSubclass, usb::kInterfaceProtocol);
  tables.add(usb::kFrameEndpoint, usb_redir_type_bulk, usb::kScannerInterface, usb::kBulkPacketBytes);
  if (device.has_camera()) {
    tables.add_interface(usb::kCameraControlInterface, kVideoClass, 1, 0);
    tables.add_interface(usb::kCameraInterface, kVideoClass, 2, 0);
    tables.add(usb::kCameraEndpoint, usb_redir_type_bulk, usb::kCameraInterface, usb::kBulkPacketBytes);
  }
  usbredirparser_send_interface_info(parser.get(), &tables.interfaces);
  usbredirparser_send_ep_info(parser.get(), &tables.endpoints);
  const auto& bytes = device.descriptors().device;
  usb_redir_device_connect_header connected{};
  connected.speed = usb_redir_speed_high;
  connected.device_class = bytes[4];
  connected.device_subclass = bytes[5];
  connected.device_protocol = bytes[6];
  connected.vendor_id = usb::kVendorId;
  connected.product_id = usb::kProductId;
  connected.device_version_bcd = 0x0100;
  usbredirparser_send_device_connect(parser.get(), &connected);
  plugged = true;
}

void UsbredirPort::answer(const usb::TransferAnswer& transfer) {
  usb_redir_bulk_packet_header header{};
  header.endpoint = transfer.endpoint;
  header.status = wire_status(transfer.status);
  header.length = static_cast<std::uint16_t>(transfer.bytes.size());
  header.length_high = static_cast<std::uint16_t>(transfer.bytes.size() >> 16);
  // the library copies the bytes; its parameter is not const
  usbredirparser_send_bulk_packet(parser.get(), transfer.id, &header, const_cast<std::uint8_t*>(transfer.bytes.data()),
                                  static_cast<int>(transfer.bytes.size()));
}

void UsbredirPort::answer_control(std::uint64_t id, usb_redir_control_packet_header header,
                                  std::span<const std::uint8_t> data) {
  const usb::ControlRequest request{header.requesttype, header.request, header.value, header.index, header.length};
  auto reply = device.control(request, data);
  header.status = reply ? usb_redir_success : usb_redir_stall;
  const bool in = (header.endpoint & 0x80) != 0;
  if (in) header.length = static_cast<std::uint16_t>(reply ? reply->size() : 0);
  const bool has_data = in && reply && !reply->empty();
  usbredirparser_send_control_packet(parser.get(), id, &header, has_data ? reply->data() : nullptr,
                                     has_data ? static_cast<int>(reply->size()) : 0);
}

}  // namespace scree::drivers
