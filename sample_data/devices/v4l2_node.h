// SPDX-License-Identifier: Apache-2.0
/// A V4L2 camera before the bench: the node /dev/videoN and the answers to its ioctls.
///
/// It runs freely as such cameras do, but begins a frame only when somebody asks for one, so that
/// every frame that is computed is taken. Formats: 8 bits, the sensor's own, 16 bits; sizes: the
/// sensor's alone. Controls: exposure (100 us), gain (dB), automatic exposure, and what a person
/// does in a lab (lab_subject, lab_target_view, lab_shot).
#pragma once

#include "sample_data/devices/lab_state.h"
#include "sample_data/devices/test_bed.h"
#include "sample_data/gige/pixel_format.h"

#include <linux/videodev2.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <string>
#include <vector>

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
    struct Control {
        std::uint32_t id;
        const char* name;
        std::uint32_t type;
        int least, most, value;
    };
    struct Format {
        std::uint32_t fourcc;
        const char* description;
        gige::PixelFormat pixels;
    };

    void on_ioctl(UMockdevIoctlClient* client);
    void forget_client();
    /// 0 or an errno.
    int answer(unsigned long request, void* argument);
    int answer_format(unsigned long request, void* argument);
    int answer_control(unsigned long request, void* argument);
    /// Several controls at once, behind a pointer.
    int answer_controls(unsigned long request, UMockdevIoctlData* data);
    int get_control(v4l2_control& control) const;
    int answer_stream(unsigned long request, void* argument);
    int enumerate_format(v4l2_fmtdesc& description) const;
    int enumerate_size(v4l2_frmsizeenum& size) const;
    int query_control(v4l2_queryctrl& query) const;
    int query_menu(v4l2_querymenu& menu) const;
    int set_control(const v4l2_control& control);
    int request_buffers(v4l2_requestbuffers& request);
    int take_frame(v4l2_buffer& buffer);
    void expose_into(v4l2_buffer& buffer);
    v4l2_pix_format layout_of(const Format& format) const;
    std::size_t slot_bytes() const;
    int control_value(std::uint32_t id) const;
    void unmap();

    LabState& lab_;
    std::vector<Format> formats_;
    std::size_t format_ = 0;  // in use
    std::vector<Control> controls_;
    int file_ = -1;                   // the node is a file, so that clients can map it
    std::uint8_t* memory_ = nullptr;  // all buffers
    std::size_t memory_bytes_ = 0;
    unsigned buffers_ = 0;
    const UMockdevIoctlClient* owner_ = nullptr;  // of the buffers
    std::deque<unsigned> queued_;
    bool is_streaming_ = false;
    int empty_polls_left_ = 0;
    std::uint32_t sequence_ = 0;
    /// Of the frame under way; none: 0.
    std::chrono::steady_clock::time_point begin_{};
    IoctlNode node_;  // last: answers from when all else is there
};

}  // namespace nearfield::devices
