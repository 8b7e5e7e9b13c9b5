// SPDX-License-Identifier: Apache-2.0
#include "acquire/usb_instruments.h"

#include "acquire/usbtmc.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace nearfield::acquire {
namespace {

constexpr std::uint8_t kUsbtmcClass = 0xFE, kUsbtmcSubclass = 0x03;

std::optional<UsbtmcEndpoints> endpoints_of(libusb_device* device) {
    libusb_config_descriptor* raw = nullptr;
    if (libusb_get_active_config_descriptor(device, &raw) != 0)
        return std::nullopt;
    const UsbConfiguration configuration(raw);
    for (int k = 0; k < configuration->bNumInterfaces; ++k) {
        const libusb_interface_descriptor& interface = configuration->interface[k].altsetting[0];
        if (interface.bInterfaceClass != kUsbtmcClass ||
            interface.bInterfaceSubClass != kUsbtmcSubclass)
            continue;
        UsbtmcEndpoints found{interface.bInterfaceNumber, 0, 0};
        for (int j = 0; j < interface.bNumEndpoints; ++j) {
            const libusb_endpoint_descriptor& endpoint = interface.endpoint[j];
            if ((endpoint.bmAttributes & 3) != LIBUSB_TRANSFER_TYPE_BULK)
                continue;
            const bool is_in = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0;
            (is_in ? found.in : found.out) = endpoint.bEndpointAddress;
        }
        if (found.in != 0 && found.out != 0)
            return found;
    }
    return std::nullopt;
}

std::string text_of(libusb_device_handle* handle, std::uint8_t index) {
    std::array<unsigned char, 256> bytes{};
    const int length = index == 0
                           ? 0
                           : libusb_get_string_descriptor_ascii(handle, index, bytes.data(),
                                                                static_cast<int>(bytes.size()));
    return length > 0 ? std::string(bytes.begin(), bytes.begin() + length) : std::string();
}

std::string vendor_product(const libusb_device_descriptor& descriptor) {
    return fmt::format("{:04x}:{:04x}", descriptor.idVendor, descriptor.idProduct);
}

using UseInstrument =
    std::function<void(libusb_device*, const FoundInstrument&, const std::string& vendor_product)>;

void for_each_instrument(libusb_context* context, const UseInstrument& use) {
    libusb_device** raw = nullptr;
    const ssize_t count = libusb_get_device_list(context, &raw);
    check_usb(static_cast<int>(count), "list USB devices", "USB");
    const UsbList list(raw);
    for (ssize_t k = 0; k < count; ++k) {
        libusb_device* device = list.get()[k];
        if (!endpoints_of(device))
            continue;
        libusb_device_descriptor descriptor{};
        libusb_get_device_descriptor(device, &descriptor);
        FoundInstrument found;
        found.address = fmt::format("usb {:03}:{:03}", libusb_get_bus_number(device),
                                    libusb_get_device_address(device));
        libusb_device_handle* opened = nullptr;
        if (libusb_open(device, &opened) == 0) {
            const UsbHandle handle(opened);
            found.vendor = text_of(opened, descriptor.iManufacturer);
            found.model = text_of(opened, descriptor.iProduct);
            found.serial = text_of(opened, descriptor.iSerialNumber);
        }
        found.id = found.serial.empty() ? vendor_product(descriptor) : found.serial;
        use(device, found, vendor_product(descriptor));
    }
}

}  // namespace

std::vector<FoundInstrument> find_instruments() {
    const UsbContext context = usb_context();
    std::vector<FoundInstrument> all;
    for_each_instrument(context.get(), [&](libusb_device*, const FoundInstrument& found,
                                           const std::string&) { all.push_back(found); });
    std::sort(all.begin(), all.end(),
              [](const auto& a, const auto& b) { return a.address < b.address; });
    return all;
}

OpenInstrument open_instrument(libusb_context* context, const std::string& device) {
    std::vector<libusb_device*> meant;
    std::string listed;
    for_each_instrument(
        context, [&](libusb_device* one, const FoundInstrument& found, const std::string& ids) {
            listed += (listed.empty() ? "" : ", ") + found.id;
            if (device == found.id || device == ids)
                meant.push_back(libusb_ref_device(one));
        });
    const std::unique_ptr<std::vector<libusb_device*>, void (*)(std::vector<libusb_device*>*)>
        unref(&meant, [](std::vector<libusb_device*>* list) {
            for (libusb_device* one : *list)
                libusb_unref_device(one);
        });
    if (meant.empty())
        throw DeviceLost{"no such instrument", device, "one of those connected",
                         listed.empty() ? "none" : listed};
    if (meant.size() > 1)
        throw Error{"which instrument is meant", device, "a serial number", listed};
    libusb_device_handle* opened = nullptr;
    check_usb(libusb_open(meant.front(), &opened), "open instrument", device);
    OpenInstrument open{UsbHandle(opened), *endpoints_of(meant.front())};
    libusb_set_auto_detach_kernel_driver(opened, 1);
    check_usb(libusb_claim_interface(opened, open.endpoints.interface), "open instrument", device);
    return open;
}

}  // namespace nearfield::acquire
