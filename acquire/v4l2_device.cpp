// SPDX-License-Identifier: Apache-2.0
#include "acquire/v4l2_device.h"

#include "acquire/settings.h"
#include "formats/files/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstring>
#include <utility>

namespace nearfield::acquire {
namespace {

constexpr std::uint32_t kCapture = V4L2_BUF_TYPE_VIDEO_CAPTURE;

template <std::size_t kSize>
std::string text_of(const std::uint8_t (&bytes)[kSize]) {
    const auto* text = reinterpret_cast<const char*>(bytes);
    return {text, strnlen(text, kSize)};
}

bool is_gone(int error) {
    return error == ENODEV || error == ENXIO || error == EIO || error == ENOENT;
}

std::string name_of_fourcc(std::uint32_t fourcc) {
    std::string name;
    for (int k = 0; k < 4; ++k)
        name += static_cast<char>(fourcc >> (8 * k) & 0x7FU);
    return name;
}

}  // namespace

std::string v4l2_control_name(const std::string& label) {
    std::string name;
    for (const char character : label)
        if (std::isalnum(static_cast<unsigned char>(character)) != 0)
            name += static_cast<char>(std::tolower(static_cast<unsigned char>(character)));
        else if (!name.empty() && name.back() != '_')
            name += '_';
    while (!name.empty() && name.back() == '_')
        name.pop_back();
    return name;
}

V4l2Device::V4l2Device(std::string path) : path_(std::move(path)) {
    file_ = open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (file_ < 0) {
        const std::string why = system_error();
        if (is_gone(errno))
            throw DeviceLost{"cannot open camera", path_, "a device", why};
        if (errno == EBUSY)
            throw DeviceBusy{"cannot open camera", path_, "one that no other program has", why};
        throw Error{"cannot open camera", path_, "a device that may be opened (docs/bench.md)",
                    why};
    }
    const bool answers = call(VIDIOC_QUERYCAP, &capability_) == 0;
    constexpr std::uint32_t kNeeded = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    const std::uint32_t can = (capability_.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                  ? capability_.device_caps
                                  : capability_.capabilities;
    if (!answers || (can & kNeeded) != kNeeded) {
        close(file_);
        throw Error{"cannot open camera", path_, "video capture by streaming",
                    answers ? fmt::format("capabilities {:08x}", can) : "no answer"};
    }
    list_controls();
}

V4l2Device::~V4l2Device() {
    stop();
    close(file_);
}

std::string V4l2Device::driver() const {
    return text_of(capability_.driver);
}
std::string V4l2Device::card() const {
    return text_of(capability_.card);
}
std::string V4l2Device::bus() const {
    return text_of(capability_.bus_info);
}

int V4l2Device::call(unsigned long request, void* argument) const {
    int result = 0;
    do
        result = ioctl(file_, request, argument);
    while (result < 0 && errno == EINTR);
    return result;
}

void V4l2Device::require(unsigned long request, void* argument, const std::string& what) const {
    if (call(request, argument) != 0)
        fail(what);
}

void V4l2Device::fail(const std::string& what) const {
    const std::string why = system_error();
    if (is_gone(errno))
        throw DeviceLost{"cannot " + what, path_, "the device to answer", why};
    if (errno == EBUSY)
        throw DeviceBusy{"cannot " + what, path_, "a camera that no other program has", why};
    throw Error{"cannot " + what, path_, "", why};
}

void V4l2Device::list_controls() {
    v4l2_queryctrl query{};
    for (query.id = V4L2_CTRL_FLAG_NEXT_CTRL; call(VIDIOC_QUERYCTRL, &query) == 0;
         query.id |= V4L2_CTRL_FLAG_NEXT_CTRL) {
        const bool is_number =
            query.type == V4L2_CTRL_TYPE_INTEGER || query.type == V4L2_CTRL_TYPE_BOOLEAN ||
            query.type == V4L2_CTRL_TYPE_MENU || query.type == V4L2_CTRL_TYPE_INTEGER_MENU;
        if (is_number && (query.flags & V4L2_CTRL_FLAG_DISABLED) == 0)
            controls_[v4l2_control_name(text_of(query.name))] = {
                query.id, query.minimum, query.maximum,
                (query.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0};
    }
}

int V4l2Device::value(const std::string& control) const {
    v4l2_control read{controls_.at(control).id, 0};
    require(VIDIOC_G_CTRL, &read, "read " + control);
    return read.value;
}

void V4l2Device::set(const std::string& control, int value) {
    const auto found = controls_.find(control);
    if (found == controls_.end()) {
        std::vector<std::string> names;
        for (const auto& [name, known] : controls_)
            names.push_back(name);
        throw Error{"the camera has no such control", path_,
                    fmt::format("one of {}", fmt::join(names, ", ")), control};
    }
    const V4l2Control& known = found->second;
    if (value < known.least || value > known.most)
        throw Error{"control out of the camera's range", path_ + ", " + control,
                    fmt::format("{} ... {}", known.least, known.most), fmt::format("{}", value)};
    v4l2_control write{known.id, value};
    require(VIDIOC_S_CTRL, &write, "set " + control);
    check_taken(control, value, this->value(control), 0);
}

std::vector<std::string> V4l2Device::format_names() const {
    std::vector<std::string> names;
    v4l2_fmtdesc description{};
    description.type = kCapture;
    for (; call(VIDIOC_ENUM_FMT, &description) == 0; ++description.index)
        names.push_back(fmt::format("'{}'", name_of_fourcc(description.pixelformat)));
    return names;
}

glm::ivec2 V4l2Device::largest(std::uint32_t fourcc) const {
    glm::ivec2 largest{0};
    v4l2_frmsizeenum size{};
    size.pixel_format = fourcc;
    for (; call(VIDIOC_ENUM_FRAMESIZES, &size) == 0; ++size.index) {
        const bool is_discrete = size.type == V4L2_FRMSIZE_TYPE_DISCRETE;
        const auto width =
            static_cast<int>(is_discrete ? size.discrete.width : size.stepwise.max_width);
        const auto height =
            static_cast<int>(is_discrete ? size.discrete.height : size.stepwise.max_height);
        if (std::int64_t{width} * height > std::int64_t{largest.x} * largest.y)
            largest = {width, height};
        if (!is_discrete)
            break;
    }
    if (largest.x == 0)
        throw Error{"the camera has no such pixel format", path_,
                    fmt::format("one of {}", fmt::join(format_names(), ", ")),
                    fmt::format("'{}'", name_of_fourcc(fourcc))};
    return largest;
}

v4l2_pix_format V4l2Device::set_format(std::uint32_t fourcc, glm::ivec2 size_px) {
    v4l2_format format{};
    format.type = kCapture;
    format.fmt.pix.width = static_cast<std::uint32_t>(size_px.x);
    format.fmt.pix.height = static_cast<std::uint32_t>(size_px.y);
    format.fmt.pix.pixelformat = fourcc;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    require(VIDIOC_S_FMT, &format, "set the format");
    const v4l2_pix_format& taken = format.fmt.pix;
    if (taken.pixelformat != fourcc)
        throw Error{"the camera does not take a setting", path_ + ", pixel format",
                    name_of_fourcc(fourcc), name_of_fourcc(taken.pixelformat)};
    check_taken("width, px", size_px.x, taken.width, 0);
    check_taken("height, px", size_px.y, taken.height, 0);
    return taken;
}

}  // namespace nearfield::acquire
