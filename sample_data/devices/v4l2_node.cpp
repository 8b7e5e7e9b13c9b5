// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/v4l2_node.h"

#include "formats/files/error.h"
#include "sample_data/devices/fixed_text.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::devices {
namespace {

using std::chrono::steady_clock;

std::string node_path(int number) {
    return fmt::format("/dev/video{}", number);
}

TestBed& with_node(TestBed& bed, int number) {
    // "N: name=00" makes a file, which can be mapped; without content it would be a terminal.
    bed.add(fmt::format(
        "P: /devices/pci0000:00/0000:00:14.0/usb1/1-1{0}/1-1{0}:1.0/video4linux/video{0}\n"
        "N: video{0}=00\nE: DEVNAME=/dev/video{0}\nE: SUBSYSTEM=video4linux\nE: MAJOR=81\n"
        "E: MINOR={0}\nA: name=nearfield virtual bench\\n\nA: index=0\\n\nA: dev=81:{0}\\n\n\n",
        number));
    return bed;
}

// What only who has the buffers may do, while there are any.
bool is_owners(unsigned long request) {
    constexpr std::array kOwners = {VIDIOC_S_FMT, VIDIOC_REQBUFS,  VIDIOC_QBUF,
                                    VIDIOC_DQBUF, VIDIOC_STREAMON, VIDIOC_STREAMOFF};
    return std::find(kOwners.begin(), kOwners.end(), request) != kOwners.end();
}

// Takes one from a count of coming misbehaviors.
bool take(std::atomic<int>& count) {
    if (count <= 0)
        return false;
    --count;
    return true;
}

}  // namespace

V4l2Node::V4l2Node(TestBed& bed, LabState& lab, int number)
    : lab_(lab),
      formats_(lab.lab()),
      controls_(lab),
      node_(with_node(bed, number), node_path(number), [this](UMockdevIoctlClient* client) {
          on_ioctl(client);
      }) {
    file_ = open((bed.root() + node_path(number)).c_str(), O_RDWR | O_CLOEXEC);
    if (file_ < 0)
        throw Error{"cannot open simulated device", node_path(number), "", std::strerror(errno)};
}

V4l2Node::~V4l2Node() {
    unmap();
    close(file_);
}

void V4l2Node::on_ioctl(UMockdevIoctlClient* client) {
    const unsigned long request = umockdev_ioctl_client_get_request(client);
    const Handle<UMockdevIoctlData> data = load_argument(client);
    // A driver frees what a client leaves when it closes the node or dies.
    if (faults.is_gone || owner_.is_gone())
        forget_client();
    const int failure = faults.is_gone                                             ? ENODEV
                        : data == nullptr                                          ? ENOTTY
                        : buffers_ > 0 && !owner_.is(client) && is_owners(request) ? EBUSY
                        : request == VIDIOC_G_EXT_CTRLS || request == VIDIOC_S_EXT_CTRLS
                            ? controls_.answer_several(request, data.get())
                            : answer(request, data->data);
    if (request == VIDIOC_REQBUFS && failure == 0)
        owner_ = ClientRef(client);
    umockdev_ioctl_client_complete(client, failure == 0 ? 0 : -1, failure);
}

void V4l2Node::forget_client() {
    owner_ = {};
    is_streaming_ = false;
    queued_.clear();
    unmap();
    buffers_ = 0;
}

int V4l2Node::answer(unsigned long request, void* argument) {
    switch (request) {
        case VIDIOC_QUERYCAP: {
            auto& capability = *static_cast<v4l2_capability*>(argument);
            capability = {};
            put_text(capability.driver, sizeof capability.driver, "nearfield");
            put_text(capability.card, sizeof capability.card, "nearfield virtual bench");
            put_text(capability.bus_info, sizeof capability.bus_info, "usb-0000:00:14.0-1");
            capability.version = 6 << 16;
            capability.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
            capability.capabilities = capability.device_caps | V4L2_CAP_DEVICE_CAPS;
            return 0;
        }
        case VIDIOC_ENUM_FMT:
        case VIDIOC_ENUM_FRAMESIZES:
        case VIDIOC_G_FMT:
        case VIDIOC_TRY_FMT:
        case VIDIOC_S_FMT:
            return formats_.answer(request, argument, buffers_ > 0);
        case VIDIOC_ENUMINPUT: {
            auto& input = *static_cast<v4l2_input*>(argument);
            if (input.index > 0)
                return EINVAL;
            put_text(input.name, sizeof input.name, "Camera 1");
            input.type = V4L2_INPUT_TYPE_CAMERA;
            return 0;
        }
        case VIDIOC_G_INPUT:
            *static_cast<int*>(argument) = 0;
            return 0;
        case VIDIOC_S_INPUT:
            return *static_cast<int*>(argument) == 0 ? 0 : EINVAL;
        case VIDIOC_QUERYCTRL:
        case VIDIOC_QUERYMENU:
        case VIDIOC_G_CTRL:
        case VIDIOC_S_CTRL:
            return controls_.answer(request, argument);
        default:
            return answer_stream(request, argument);
    }
}

void V4l2Node::unmap() {
    if (memory_ != nullptr)
        munmap(memory_, memory_bytes_);
    memory_ = nullptr;
}

std::size_t V4l2Node::slot_bytes() const {
    constexpr std::size_t kPage = 4096;
    return (formats_.layout().sizeimage + kPage - 1) / kPage * kPage;
}

int V4l2Node::request_buffers(v4l2_requestbuffers& request) {
    constexpr unsigned kMostBuffers = 8;
    if (request.memory != V4L2_MEMORY_MMAP)
        return EINVAL;
    unmap();
    queued_.clear();
    is_streaming_ = false;
    request.count = buffers_ = std::min(request.count, kMostBuffers);
    request.capabilities = V4L2_BUF_CAP_SUPPORTS_MMAP;
    if (buffers_ == 0)
        return 0;
    memory_bytes_ = slot_bytes() * buffers_;
    if (ftruncate(file_, static_cast<off_t>(memory_bytes_)) != 0)
        return ENOMEM;
    void* memory = mmap(nullptr, memory_bytes_, PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
    if (memory == MAP_FAILED)
        return ENOMEM;
    memory_ = static_cast<std::uint8_t*>(memory);
    return 0;
}

void V4l2Node::expose_into(v4l2_buffer& buffer) {
    const gige::Lab& lab = lab_.lab();
    const gige::PixelFormat pixels = formats_.pixels();
    const gige::FormatInfo info = *gige::format_info(static_cast<std::uint32_t>(pixels));
    const std::vector<std::uint8_t> bytes = gige::pack(
        pixels, gige::crop(lab_.expose(controls_.exposure_us(), controls_.gain_db()), lab.sensor_px,
                           {0, 0}, lab.sensor_px, lab.sensor_bits, info.value_bits));
    std::copy(bytes.begin(), bytes.end(),
              memory_ + static_cast<std::size_t>(buffer.index) * slot_bytes());
    buffer.bytesused = static_cast<std::uint32_t>(bytes.size());
}

int V4l2Node::take_frame(v4l2_buffer& buffer) {
    if (!is_streaming_)
        return EINVAL;
    if (queued_.empty() || faults.is_silent || empty_polls_left_-- > 0)
        return EAGAIN;
    const steady_clock::time_point now = steady_clock::now();
    if (begin_ == steady_clock::time_point{})
        begin_ = now;
    const std::chrono::microseconds duration(lab_.is_fast() ? 0 : controls_.exposure_us());
    if (now < begin_ + duration)
        return EAGAIN;
    empty_polls_left_ = faults.empty_polls;
    buffer.index = queued_.front();
    queued_.pop_front();
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.length = formats_.layout().sizeimage;
    expose_into(buffer);
    const steady_clock::time_point stamp =
        std::exchange(begin_, {}) - std::chrono::seconds(take(faults.stale_frames) ? 10 : 0);
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(stamp.time_since_epoch());
    buffer.timestamp = {us.count() / 1'000'000, us.count() % 1'000'000};
    buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE |
                   (take(faults.broken_frames) ? V4L2_BUF_FLAG_ERROR : 0);
    if (take(faults.short_frames))
        buffer.bytesused -= formats_.layout().bytesperline;
    buffer.sequence = sequence_++;
    buffer.field = V4L2_FIELD_NONE;
    buffer.m.offset = static_cast<std::uint32_t>(slot_bytes() * buffer.index);
    return 0;
}

int V4l2Node::answer_stream(unsigned long request, void* argument) {
    switch (request) {
        case VIDIOC_REQBUFS:
            return request_buffers(*static_cast<v4l2_requestbuffers*>(argument));
        case VIDIOC_QUERYBUF: {
            auto& buffer = *static_cast<v4l2_buffer*>(argument);
            if (buffer.index >= buffers_)
                return EINVAL;
            buffer.memory = V4L2_MEMORY_MMAP;
            buffer.length = formats_.layout().sizeimage;
            buffer.m.offset = static_cast<std::uint32_t>(slot_bytes() * buffer.index);
            buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
            return 0;
        }
        case VIDIOC_QBUF: {
            auto& buffer = *static_cast<v4l2_buffer*>(argument);
            const bool is_queued =
                std::find(queued_.begin(), queued_.end(), buffer.index) != queued_.end();
            if (buffer.index >= buffers_ || is_queued || buffer.memory != V4L2_MEMORY_MMAP)
                return EINVAL;
            queued_.push_back(buffer.index);
            buffer.flags |= V4L2_BUF_FLAG_QUEUED;
            return 0;
        }
        case VIDIOC_DQBUF:
            return take_frame(*static_cast<v4l2_buffer*>(argument));
        case VIDIOC_STREAMON:
            if (buffers_ == 0)
                return EINVAL;
            is_streaming_ = true;
            begin_ = {};
            sequence_ = 0;
            return 0;
        case VIDIOC_STREAMOFF:
            is_streaming_ = false;
            queued_.clear();
            return 0;
        default:
            return ENOTTY;
    }
}

}  // namespace nearfield::devices
