// SPDX-License-Identifier: Apache-2.0
/// The pixel formats of a V4L2 camera before the bench: the sensor's bits, 8, 10 and 16; sizes: the
/// sensor's alone.
#pragma once

#include "sample_data/gige/camera.h"
#include "sample_data/gige/pixel_format.h"

#include <linux/videodev2.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace nearfield::devices {

class V4l2Formats {
  public:
    explicit V4l2Formats(const gige::Lab& lab);

    /// VIDIOC_ENUM_FMT, ENUM_FRAMESIZES, G_FMT, TRY_FMT, S_FMT. 0 or an errno. What is not offered
    /// becomes what is, as V4L2 asks for. `is_locked`: buffers exist.
    int answer(unsigned long request, void* argument, bool is_locked);

    gige::PixelFormat pixels() const { return formats_[in_use_].pixels; }
    v4l2_pix_format layout() const { return layout_of(formats_[in_use_]); }

  private:
    struct Format {
        std::uint32_t fourcc;
        const char* description;
        gige::PixelFormat pixels;
    };

    int enumerate(v4l2_fmtdesc& description) const;
    int enumerate_size(v4l2_frmsizeenum& size) const;
    v4l2_pix_format layout_of(const Format& format) const;

    glm::ivec2 size_px_;
    std::vector<Format> formats_;
    std::size_t in_use_ = 0;
};

}  // namespace nearfield::devices
