// SPDX-License-Identifier: Apache-2.0
// Programs that die while the simulated devices answer them. The killed captures of tests/cli show
// that nothing else of them stays behind; here the moments are chosen.
#include "acquire/usbtmc.h"
#include "acquire/v4l2_camera.h"
#include "tests/devices/test_lab.h"

#include <gtest/gtest.h>
#include <linux/usbdevice_fs.h>
#include <linux/videodev2.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>

namespace nearfield::devices {
namespace {

using Message = std::array<unsigned long, 3>;
constexpr unsigned long kIoctl = 1, kReadMemory = 5;  // of umockdev's protocol

// A connection as libumockdev-preload makes one for every open node.
class RawClient {
  public:
    RawClient(const TestBed& bed, const std::string& node)
        : socket_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        const std::string path = bed.root() + "/ioctl" + node;
        std::copy(path.begin(), path.end(), address.sun_path);
        EXPECT_EQ(connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0)
            << path;
    }
    ~RawClient() { close(socket_); }
    RawClient(const RawClient&) = delete;
    RawClient& operator=(const RawClient&) = delete;

    void ask(unsigned long request) {
        const Message message{kIoctl, request, reinterpret_cast<unsigned long>(this)};
        EXPECT_EQ(write(socket_, message.data(), sizeof message), ssize_t{sizeof message});
    }
    /// Until the far end wants to know what the argument points to.
    void wait_until_read() {
        Message message{};
        EXPECT_EQ(recv(socket_, message.data(), sizeof message, MSG_WAITALL),
                  ssize_t{sizeof message});
        EXPECT_EQ(message[0], kReadMemory);
    }

  private:
    int socket_;
};

void die_while_asking(const TestBed& bed, const std::string& node, unsigned long request) {
    RawClient(bed, node).ask(request);
    RawClient later(bed, node);
    later.ask(request);
    later.wait_until_read();
}

class KilledClient : public testing::Test {
  protected:
    VirtualLab lab_{test_bench(), test_mounting(), true};
};

TEST_F(KilledClient, HarmsNoUsbDeviceInTheMidstOfACall) {
    for (const unsigned long request :
         {USBDEVFS_GET_CAPABILITIES, USBDEVFS_CLAIMINTERFACE, USBDEVFS_CLEAR_HALT,
          USBDEVFS_SUBMITURB, USBDEVFS_REAPURBNDELAY})
        die_while_asking(lab_.bed, "/dev/bus/usb/001/003", request);
    EXPECT_EQ(acquire::Usbtmc("NFLUX01").identity(), "NEARFIELD,VLUX,NFLUX01,1");
}

TEST_F(KilledClient, HarmsNoV4l2CameraInTheMidstOfACall) {
    for (const unsigned long request :
         {VIDIOC_QUERYCAP, VIDIOC_S_FMT, VIDIOC_REQBUFS, VIDIOC_QBUF, VIDIOC_DQBUF, VIDIOC_S_CTRL,
          VIDIOC_S_EXT_CTRLS, VIDIOC_STREAMON})
        die_while_asking(lab_.bed, "/dev/video0", request);
    const acquire::Bench bench = acquire::open_v4l2("/dev/video0");
    bench.camera->configure({});
    EXPECT_EQ(bench.camera->expose(never).frame.size_px, kSensorPx);
}

}  // namespace
}  // namespace nearfield::devices
