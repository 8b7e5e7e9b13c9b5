// SPDX-License-Identifier: Apache-2.0
/// A V4L2 camera before the bench: the node /dev/videoN and the answers to its ioctls.
///
/// It runs freely as such cameras do, but begins a frame only when somebody asks for one, so that
/// every frame that is computed is taken.
#pragma once

#include "sample_data/devices/lab_state.h"
#include "sample_data/devices/test_bed.h"
#include "sample_data/devices/v4l2_controls.h"
#include "sample_data/devices/v4l2_formats.h"

#include <linux/videodev2.h>

#include <atomic>
#include <chrono>
#include <deque>

namespace nearfield::devices {

/// Misbehavior for tests. Zeros: none.
struct V4l2Faults {
    std::atomic<int> empty_polls{0};     // DQBUF says EAGAIN so often before every frame
    std::atomic<int> stale_frames{0};    // so many next frames were exposed 10 s ago
    std::atomic<int> broken_frames{0};   // so many next frames have the error flag
    std::atomic<int> short_frames{0};    // so many next frames lack their last line
    std::atomic<bool> is_silent{false};  // no frame comes
    std::atomic<bool> is_gone{false};    // unplugged
};

class V4l2Node {
  public:
    V4l2Node(TestBed& bed, LabState& lab, int number);
    ~V4l2Node();
    V4l2Node(const V4l2Node&) = delete;
    V4l2Node& operator=(const V4l2Node&) = delete;

    V4l2Faults faults;

  private:
    void on_ioctl(UMockdevIoctlClient* client);
    void forget_client();
    /// 0 or an errno.
    int answer(unsigned long request, void* argument);
    int answer_stream(unsigned long request, void* argument);
    int request_buffers(v4l2_requestbuffers& request);
    int take_frame(v4l2_buffer& buffer);
    void expose_into(v4l2_buffer& buffer);
    std::size_t slot_bytes() const;
    void unmap();

    LabState& lab_;
    V4l2Formats formats_;
    V4l2Controls controls_;
    int file_ = -1;                   // the node is a file, so that clients can map it
    std::uint8_t* memory_ = nullptr;  // all buffers
    std::size_t memory_bytes_ = 0;
    unsigned buffers_ = 0;
    ClientRef owner_;  // of the buffers
    std::deque<unsigned> queued_;
    bool is_streaming_ = false;
    int empty_polls_left_ = 0;
    std::uint32_t sequence_ = 0;
    /// Of the frame under way; none: 0.
    std::chrono::steady_clock::time_point begin_{};
    IoctlNode node_;  // last: answers from when all else is there
};

}  // namespace nearfield::devices
