// SPDX-License-Identifier: Apache-2.0
/// A USB device for programs that use libusb: the node below /dev/bus/usb, its description below
/// /sys, and the answers to usbdevfs' ioctls.
#pragma once

#include "sample_data/devices/test_bed.h"

#include <linux/usbdevice_fs.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace nearfield::devices {

/// What a device is and does. Called by umockdev's thread alone.
class UsbFunction {
  public:
    UsbFunction() = default;
    UsbFunction(const UsbFunction&) = delete;
    UsbFunction& operator=(const UsbFunction&) = delete;
    virtual ~UsbFunction() = default;

    /// Device and configuration descriptors, one after the other.
    virtual std::vector<std::uint8_t> descriptors() const = 0;
    /// String descriptors 1, 2 ...
    virtual std::vector<std::string> texts() const = 0;
    /// A request of class or vendor (8 bytes of setup): its answer, or nothing: it stalls.
    virtual std::optional<std::vector<std::uint8_t>> control(
        std::span<const std::uint8_t> setup) = 0;
    /// Bytes from the host. False: the endpoint stalls.
    virtual bool take(std::uint8_t endpoint, std::span<const std::uint8_t> bytes) = 0;
    struct Reply {
        bool is_stall = false;
        std::vector<std::uint8_t> bytes;
    };
    /// What goes to the host, at most so many bytes; nothing yet: it is asked again.
    virtual std::optional<Reply> give(std::uint8_t endpoint, std::size_t most_bytes) = 0;
    virtual void clear_halt(std::uint8_t /*endpoint*/) {}
};

class UsbDevice {
  public:
    /// number: of the device on bus 1, from 2.
    UsbDevice(TestBed& bed, UsbFunction& function, int number, bool is_superspeed);
    ~UsbDevice();
    UsbDevice(const UsbDevice&) = delete;
    UsbDevice& operator=(const UsbDevice&) = delete;

    /// Pulls the plug: what is asked fails, and listeners are told.
    void unplug();
    void plug_in();

  private:
    struct Transfer {
        Handle<UMockdevIoctlData> urb, buffer;
        ClientRef client;

        usbdevfs_urb& get() const { return *reinterpret_cast<usbdevfs_urb*>(urb->data); }
        std::span<std::uint8_t> bytes() const {
            if (!buffer)
                return {};
            return {buffer->data, static_cast<std::size_t>(buffer->data_len)};
        }
    };
    struct Result {
        int value = 0, failure = 0;
    };

    void on_ioctl(UMockdevIoctlClient* client);
    void drop_transfers_of_the_gone();
    Result submit(UMockdevIoctlClient* client, UMockdevIoctlData* urb);
    Result discard(UMockdevIoctlClient* client);
    Result reap(UMockdevIoctlClient* client, UMockdevIoctlData* answer);
    Result answer(UMockdevIoctlClient* client, unsigned long request, UMockdevIoctlData* data);
    void complete_what_can();
    bool try_complete(Transfer& transfer);
    bool complete_control(Transfer& transfer);
    std::optional<std::vector<std::uint8_t>> standard_request(
        std::span<const std::uint8_t> setup) const;

    TestBed& bed_;
    UsbFunction& function_;
    std::string system_path_;
    std::atomic<bool> is_gone_{false};
    std::deque<Transfer> pending_, done_;
    IoctlNode node_;  // last: answers from when all else is there
};

}  // namespace nearfield::devices
