// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/usb_device.h"

#include "sample_data/devices/little_endian.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <iterator>
#include <utility>

namespace nearfield::devices {
namespace {

constexpr std::uint8_t kIn = 0x80, kStandardIn = 0x80, kGetDescriptor = 6;
constexpr std::size_t kSetupBytes = 8, kDeviceDescriptorBytes = 18;

std::string node_name(int number) {
    return fmt::format("bus/usb/001/{:03}", number);
}

std::string system_path(int number) {
    return fmt::format("/devices/pci0000:00/0000:00:14.0/usb1/1-{}", number);
}

TestBed& with_device(TestBed& bed, const UsbFunction& function, int number, bool is_superspeed) {
    const std::vector<std::uint8_t> bytes = function.descriptors();
    const std::vector<std::string> texts = function.texts();
    const std::string hex = fmt::format("{:02X}", fmt::join(bytes, ""));
    const std::string name = node_name(number);
    bed.add(fmt::format(
        "P: {}\nN: {}={}\nE: DEVNAME=/dev/{}\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\n"
        "E: MAJOR=189\nE: MINOR={}\nE: BUSNUM=001\nE: DEVNUM={:03}\nA: busnum=1\\n\nA: "
        "devnum={}\\n\n"
        "A: speed={}\\n\nA: bConfigurationValue=1\\n\nA: bNumConfigurations=1\\n\n"
        "A: idVendor={:04x}\\n\nA: idProduct={:04x}\\n\nA: manufacturer={}\\n\nA: product={}\\n\n"
        "A: serial={}\\n\nA: dev=189:{}\\n\nH: descriptors={}\n\n",
        system_path(number), name, hex, name, number - 1, number, number,
        is_superspeed ? 5000 : 480, number_at(bytes, 8, 2), number_at(bytes, 10, 2), texts.at(0),
        texts.at(1), texts.at(2), number - 1, hex));
    return bed;
}

std::vector<std::uint8_t> text_descriptor(const std::string& text) {
    std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(2 + 2 * text.size()), 3};
    for (const char character : text)
        append(bytes, static_cast<std::uint8_t>(character), 2);
    return bytes;
}

}  // namespace

UsbDevice::UsbDevice(TestBed& bed, UsbFunction& function, int number, bool is_superspeed)
    : bed_(bed),
      function_(function),
      system_path_(system_path(number)),
      node_(with_device(bed, function, number, is_superspeed),
            "/dev/" + node_name(number),
            [this](UMockdevIoctlClient* client) { on_ioctl(client); }) {}

UsbDevice::~UsbDevice() = default;

void UsbDevice::unplug() {
    is_gone_ = true;
    umockdev_testbed_uevent(bed_.get(), ("/sys" + system_path_).c_str(), "remove");
}

void UsbDevice::plug_in() {
    is_gone_ = false;
    umockdev_testbed_uevent(bed_.get(), ("/sys" + system_path_).c_str(), "add");
}

std::optional<std::vector<std::uint8_t>> UsbDevice::standard_request(
    std::span<const std::uint8_t> setup) const {
    if (setup[0] != kStandardIn || setup[1] != kGetDescriptor)
        return std::vector<std::uint8_t>{};
    const std::size_t index = setup[2];
    const std::vector<std::uint8_t> all = function_.descriptors();
    const std::vector<std::string> texts = function_.texts();
    switch (setup[3]) {
        case 1:
            return std::vector(all.begin(), all.begin() + kDeviceDescriptorBytes);
        case 2:
            return std::vector(all.begin() + kDeviceDescriptorBytes, all.end());
        case 3:
            if (index == 0)
                return std::vector<std::uint8_t>{4, 3, 9, 4};  // English
            if (index <= texts.size())
                return text_descriptor(texts[index - 1]);
            return std::nullopt;
        default:
            return std::nullopt;
    }
}

bool UsbDevice::complete_control(Transfer& transfer) {
    const std::span<std::uint8_t> bytes = transfer.bytes();
    const auto setup = bytes.first(kSetupBytes);
    const bool is_standard = (setup[0] & 0x60U) == 0;
    const auto reply = is_standard ? standard_request(setup) : function_.control(setup);
    if (!reply) {
        transfer.get().status = -EPIPE;
        return true;
    }
    const std::size_t count =
        std::min({reply->size(), bytes.size() - kSetupBytes, number_at(setup, 6, 2)});
    std::copy_n(reply->begin(), count, bytes.begin() + kSetupBytes);
    transfer.get().actual_length = static_cast<int>(count);
    return true;
}

// True where it is over, well or not.
bool UsbDevice::try_complete(Transfer& transfer) {
    usbdevfs_urb& urb = transfer.get();
    urb.status = 0;
    if (is_gone_) {
        urb.status = -ENODEV;
        return true;
    }
    if (urb.type == USBDEVFS_URB_TYPE_CONTROL)
        return complete_control(transfer);
    if ((urb.endpoint & kIn) == 0) {
        urb.status = function_.take(urb.endpoint, transfer.bytes()) ? 0 : -EPIPE;
        urb.actual_length = urb.status == 0 ? urb.buffer_length : 0;
        return true;
    }
    const auto reply = function_.give(urb.endpoint, transfer.bytes().size());
    if (!reply)
        return false;
    urb.status = reply->is_stall ? -EPIPE : 0;
    std::copy(reply->bytes.begin(), reply->bytes.end(), transfer.bytes().begin());
    urb.actual_length = static_cast<int>(reply->bytes.size());
    return true;
}

void UsbDevice::complete_what_can() {
    std::deque<Transfer> left;
    while (!pending_.empty()) {
        Transfer transfer = std::move(pending_.front());
        pending_.pop_front();
        (try_complete(transfer) ? done_ : left).push_back(std::move(transfer));
    }
    pending_ = std::move(left);
}

UsbDevice::Result UsbDevice::submit(UMockdevIoctlClient* client, UMockdevIoctlData* data) {
    Transfer transfer;
    transfer.urb.reset(static_cast<UMockdevIoctlData*>(g_object_ref(data)));
    transfer.client = ClientRef(client);
    if (transfer.get().buffer_length > 0)
        transfer.buffer.reset(
            umockdev_ioctl_data_resolve(data, offsetof(usbdevfs_urb, buffer),
                                        static_cast<gsize>(transfer.get().buffer_length), nullptr));
    if (!transfer.buffer && transfer.get().buffer_length > 0)
        return {-1, EFAULT};
    if (transfer.get().type == USBDEVFS_URB_TYPE_CONTROL && transfer.bytes().size() < kSetupBytes)
        return {-1, EINVAL};
    pending_.push_back(std::move(transfer));
    return {};
}

UsbDevice::Result UsbDevice::discard(UMockdevIoctlClient* client) {
    // The argument is the transfer's address itself, not one of something that holds it.
    const auto address =
        *reinterpret_cast<const unsigned long*>(umockdev_ioctl_client_get_arg(client)->data);
    const auto found = std::find_if(pending_.begin(), pending_.end(), [&](const Transfer& one) {
        return one.urb->client_addr == address && one.client.is(client);
    });
    if (found == pending_.end())
        return {-1, EINVAL};
    found->get().status = -ENOENT;
    found->get().actual_length = 0;
    done_.push_back(std::move(*found));
    pending_.erase(found);
    return {};
}

UsbDevice::Result UsbDevice::reap(UMockdevIoctlClient* client, UMockdevIoctlData* answer) {
    complete_what_can();
    const auto found = std::find_if(done_.begin(), done_.end(), [client](const Transfer& one) {
        return one.client.is(client);
    });
    if (found == done_.end())
        return {-1, is_gone_ ? ENODEV : EAGAIN};
    umockdev_ioctl_data_set_ptr(answer, 0, found->urb.get());
    done_.erase(found);
    return {};
}

UsbDevice::Result UsbDevice::answer(UMockdevIoctlClient* client,
                                    unsigned long request,
                                    UMockdevIoctlData* data) {
    const bool is_reap = request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY;
    if (is_gone_ && !is_reap && request != USBDEVFS_DISCARDURB)
        return {-1, ENODEV};
    switch (request) {
        case USBDEVFS_GET_CAPABILITIES:
            *reinterpret_cast<std::uint32_t*>(data->data) =
                USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION |
                USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_BULK_SCATTER_GATHER |
                USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
            return {};
        case USBDEVFS_CLEAR_HALT:
            function_.clear_halt(data->data[0]);
            return {};
        case USBDEVFS_CLAIMINTERFACE:
        case USBDEVFS_DISCONNECT_CLAIM:
        case USBDEVFS_RELEASEINTERFACE:
        case USBDEVFS_SETINTERFACE:
        case USBDEVFS_SETCONFIGURATION:
        case USBDEVFS_RESET:
            return {};
        case USBDEVFS_GETDRIVER:  // no kernel driver has it
        case USBDEVFS_IOCTL:
            return {-1, ENODATA};
        case USBDEVFS_SUBMITURB:
            return submit(client, data);
        case USBDEVFS_DISCARDURB:
            return discard(client);
        case USBDEVFS_REAPURB:
        case USBDEVFS_REAPURBNDELAY:
            return reap(client, data);
        default:
            return {-1, ENOTTY};
    }
}

void UsbDevice::on_ioctl(UMockdevIoctlClient* client) {
    const unsigned long request = umockdev_ioctl_client_get_request(client);
    const bool has_argument = _IOC_SIZE(request) > 0 && request != USBDEVFS_DISCARDURB;
    const Handle<UMockdevIoctlData> data = has_argument ? load_argument(client) : nullptr;
    drop_transfers_of_the_gone();
    const Result result =
        has_argument && !data ? Result{-1, EFAULT} : answer(client, request, data.get());
    umockdev_ioctl_client_complete(client, result.value, result.failure);
}

// What a client that died has left would take the answers to the next one's questions.
void UsbDevice::drop_transfers_of_the_gone() {
    const auto is_of_gone = [](const Transfer& one) { return one.client.is_gone(); };
    std::erase_if(pending_, is_of_gone);
    std::erase_if(done_, is_of_gone);
}

}  // namespace nearfield::devices
