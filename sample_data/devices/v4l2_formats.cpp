// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/v4l2_formats.h"

#include "sample_data/devices/fixed_text.h"

#include <algorithm>
#include <cerrno>

namespace nearfield::devices {

V4l2Formats::V4l2Formats(const gige::Lab& lab) : size_px_(lab.sensor_px) {
    using gige::PixelFormat;
    formats_ = lab.is_bayer ? std::vector<Format>{{V4L2_PIX_FMT_SRGGB12, "12-bit Bayer RGRG/GBGB",
                                                   PixelFormat::BayerRG12},
                                                  {V4L2_PIX_FMT_SRGGB8, "8-bit Bayer RGRG/GBGB",
                                                   PixelFormat::BayerRG8}}
                            : std::vector<Format>{
                                  {V4L2_PIX_FMT_Y12, "12-bit Greyscale", PixelFormat::Mono12},
                                  {V4L2_PIX_FMT_GREY, "8-bit Greyscale", PixelFormat::Mono8},
                                  {V4L2_PIX_FMT_Y10, "10-bit Greyscale", PixelFormat::Mono10},
                                  {V4L2_PIX_FMT_Y16, "16-bit Greyscale", PixelFormat::Mono16}};
}

v4l2_pix_format V4l2Formats::layout_of(const Format& format) const {
    v4l2_pix_format layout{};
    layout.width = static_cast<std::uint32_t>(size_px_.x);
    layout.height = static_cast<std::uint32_t>(size_px_.y);
    layout.pixelformat = format.fourcc;
    layout.field = V4L2_FIELD_NONE;
    layout.sizeimage = static_cast<std::uint32_t>(gige::payload_bytes(format.pixels, size_px_));
    layout.bytesperline = layout.sizeimage / layout.height;
    layout.colorspace = V4L2_COLORSPACE_RAW;
    return layout;
}

int V4l2Formats::enumerate(v4l2_fmtdesc& description) const {
    if (description.type != V4L2_BUF_TYPE_VIDEO_CAPTURE || description.index >= formats_.size())
        return EINVAL;
    const Format& format = formats_[description.index];
    description.flags = 0;
    description.pixelformat = format.fourcc;
    put_text(description.description, sizeof description.description, format.description);
    return 0;
}

int V4l2Formats::enumerate_size(v4l2_frmsizeenum& size) const {
    const auto is_it = [&](const Format& format) { return format.fourcc == size.pixel_format; };
    if (size.index > 0 || std::none_of(formats_.begin(), formats_.end(), is_it))
        return EINVAL;
    size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    size.discrete = {static_cast<std::uint32_t>(size_px_.x),
                     static_cast<std::uint32_t>(size_px_.y)};
    return 0;
}

int V4l2Formats::answer(unsigned long request, void* argument, bool is_locked) {
    if (request == VIDIOC_ENUM_FMT)
        return enumerate(*static_cast<v4l2_fmtdesc*>(argument));
    if (request == VIDIOC_ENUM_FRAMESIZES)
        return enumerate_size(*static_cast<v4l2_frmsizeenum*>(argument));
    auto& asked = *static_cast<v4l2_format*>(argument);
    if (asked.type != V4L2_BUF_TYPE_VIDEO_CAPTURE)
        return EINVAL;
    std::size_t format = in_use_;
    if (request != VIDIOC_G_FMT) {
        format = 0;
        for (std::size_t k = 0; k < formats_.size(); ++k)
            if (formats_[k].fourcc == asked.fmt.pix.pixelformat)
                format = k;
    }
    if (request == VIDIOC_S_FMT) {
        if (is_locked)
            return EBUSY;
        in_use_ = format;
    }
    asked.fmt.pix = layout_of(formats_[format]);
    return 0;
}

}  // namespace nearfield::devices
