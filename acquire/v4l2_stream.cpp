// SPDX-License-Identifier: Apache-2.0
// The buffers of a V4L2 camera, from the driver's memory to ours and back.
#include "acquire/v4l2_device.h"
#include "formats/files/error.h"
#include "formats/files/provenance.h"

#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <thread>
#include <utility>

namespace nearfield::acquire {
namespace {

// An empty structure of the kernel's about our buffers.
template <typename Request>
Request about_buffers() {
    Request request{};
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    return request;
}

}  // namespace

void V4l2Device::start(unsigned buffers) {
    stop();
    auto request = about_buffers<v4l2_requestbuffers>();
    request.count = buffers;
    require(VIDIOC_REQBUFS, &request, "get buffers");
    for (unsigned k = 0; k < request.count; ++k) {
        auto buffer = about_buffers<v4l2_buffer>();
        buffer.index = k;
        require(VIDIOC_QUERYBUF, &buffer, "find a buffer");
        void* memory = mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, file_,
                            buffer.m.offset);
        if (memory == MAP_FAILED)
            throw Error{"cannot map a buffer", path_, "", system_error()};
        mapped_.emplace_back(static_cast<unsigned char*>(memory), buffer.length);
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    require(VIDIOC_STREAMON, &type, "start the camera");
    is_streaming_ = true;
}

void V4l2Device::stop() {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (std::exchange(is_streaming_, false))
        call(VIDIOC_STREAMOFF, &type);  // a device that is gone has stopped
    const bool had_buffers = !mapped_.empty();
    for (const std::span<unsigned char> memory : mapped_)
        munmap(memory.data(), memory.size());
    mapped_.clear();
    auto none = about_buffers<v4l2_requestbuffers>();
    if (had_buffers)
        call(VIDIOC_REQBUFS, &none);  // or the format stays locked
}

void V4l2Device::queue(unsigned index) {
    auto buffer = about_buffers<v4l2_buffer>();
    buffer.index = index;
    require(VIDIOC_QBUF, &buffer, "queue a buffer");
}

std::optional<V4l2Buffer> V4l2Device::dequeue(double patience_s) {
    for (const double end_s = now_s() + patience_s;;) {
        const double left_s = end_s - now_s();
        pollfd ready{file_, POLLIN, 0};
        if (poll(&ready, 1, std::max(0, static_cast<int>(left_s * 1000))) < 0 && errno != EINTR)
            throw Error{"cannot wait for a frame", path_, "", system_error()};
        auto buffer = about_buffers<v4l2_buffer>();
        if (call(VIDIOC_DQBUF, &buffer) == 0) {
            const bool is_monotonic =
                (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
            const std::span<unsigned char> memory = mapped_.at(buffer.index);
            return V4l2Buffer{
                buffer.index,
                memory.first(std::min<std::size_t>(buffer.bytesused, memory.size())),
                buffer.sequence,
                is_monotonic ? static_cast<double>(buffer.timestamp.tv_sec) +
                                   1e-6 * static_cast<double>(buffer.timestamp.tv_usec)
                             : 0,
                (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE,
                (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0};
        }
        if (errno != EAGAIN)
            fail("take a frame");
        if (now_s() >= end_s)
            return std::nullopt;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

}  // namespace nearfield::acquire
