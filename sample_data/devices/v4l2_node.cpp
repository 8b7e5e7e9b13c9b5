// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/v4l2_node.h"

#include "formats/files/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <utility>

namespace nearfield::devices {
namespace {

using std::chrono::steady_clock;

constexpr std::uint32_t kCapture = V4L2_BUF_TYPE_VIDEO_CAPTURE;
constexpr std::uint32_t kLabControls = V4L2_CID_USER_BASE + 0x1F00;
constexpr std::uint32_t kSubject = kLabControls, kTargetView = kLabControls + 1,
                        kShot = kLabControls + 2;
constexpr int kMostShot = 0x7FFFFFFF;
constexpr double kExposureUnit_us = 100;

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

// By pointer: the kernel packs some of these structures.
void put(std::uint8_t* to, std::size_t bytes, std::string_view text) {
    std::fill_n(to, bytes, std::uint8_t{0});
    std::copy_n(text.begin(), std::min(text.size(), bytes - 1), to);
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
      node_(with_node(bed, number), node_path(number), [this](UMockdevIoctlClient* client) {
          on_ioctl(client);
      }) {
    using gige::PixelFormat;
    const bool is_bayer = lab.lab().is_bayer;
    formats_ =
        is_bayer ? std::vector<Format>{{V4L2_PIX_FMT_SRGGB12, "12-bit Bayer RGRG/GBGB",
                                        PixelFormat::BayerRG12},
                                       {V4L2_PIX_FMT_SRGGB8, "8-bit Bayer RGRG/GBGB",
                                        PixelFormat::BayerRG8}}
                 : std::vector<Format>{{V4L2_PIX_FMT_Y12, "12-bit Greyscale", PixelFormat::Mono12},
                                       {V4L2_PIX_FMT_GREY, "8-bit Greyscale", PixelFormat::Mono8},
                                       {V4L2_PIX_FMT_Y10, "10-bit Greyscale", PixelFormat::Mono10},
                                       {V4L2_PIX_FMT_Y16, "16-bit Greyscale", PixelFormat::Mono16}};
    constexpr std::uint32_t kInteger = V4L2_CTRL_TYPE_INTEGER, kMenu = V4L2_CTRL_TYPE_MENU;
    controls_ = {
        {V4L2_CID_GAIN, "Gain", kInteger, 0, 24, 0},
        {kSubject, "Lab Subject", kInteger, 0, 6, 0},
        {kTargetView, "Lab Target View", kInteger, 0, std::max(0, lab.lab().target_views - 1), 0},
        {kShot, "Lab Shot", kInteger, 0, kMostShot, 0},
        {V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", kMenu, 0, 3, 3},
        {V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", kInteger, 1, 100000, 100}};
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
    const std::size_t bytes = _IOC_SIZE(request);
    Handle<UMockdevIoctlData> data(
        bytes == 0 ? nullptr
                   : umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, bytes,
                                                 nullptr));
    // A driver frees what a client leaves when it closes the node or dies, which is not told here:
    // the next one takes it over.
    if (faults.is_gone || (request == VIDIOC_S_FMT && client != owner_))
        forget_client();
    const int failure = faults.is_gone    ? ENODEV
                        : data == nullptr ? ENOTTY
                        : request == VIDIOC_G_EXT_CTRLS || request == VIDIOC_S_EXT_CTRLS
                            ? answer_controls(request, data.get())
                            : answer(request, data->data);
    if (request == VIDIOC_REQBUFS && failure == 0)
        owner_ = client;
    umockdev_ioctl_client_complete(client, failure == 0 ? 0 : -1, failure);
}

void V4l2Node::forget_client() {
    owner_ = nullptr;
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
            put(capability.driver, sizeof capability.driver, "nearfield");
            put(capability.card, sizeof capability.card, "nearfield virtual bench");
            put(capability.bus_info, sizeof capability.bus_info, "usb-0000:00:14.0-1");
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
            return answer_format(request, argument);
        case VIDIOC_ENUMINPUT: {
            auto& input = *static_cast<v4l2_input*>(argument);
            if (input.index > 0)
                return EINVAL;
            put(input.name, sizeof input.name, "Camera 1");
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
            return answer_control(request, argument);
        default:
            return answer_stream(request, argument);
    }
}

v4l2_pix_format V4l2Node::layout_of(const Format& format) const {
    const glm::ivec2 size = lab_.lab().sensor_px;
    v4l2_pix_format layout{};
    layout.width = static_cast<std::uint32_t>(size.x);
    layout.height = static_cast<std::uint32_t>(size.y);
    layout.pixelformat = format.fourcc;
    layout.field = V4L2_FIELD_NONE;
    layout.sizeimage = static_cast<std::uint32_t>(gige::payload_bytes(format.pixels, size));
    layout.bytesperline = layout.sizeimage / layout.height;
    layout.colorspace = V4L2_COLORSPACE_RAW;
    return layout;
}

int V4l2Node::enumerate_format(v4l2_fmtdesc& description) const {
    if (description.type != kCapture || description.index >= formats_.size())
        return EINVAL;
    const Format& format = formats_[description.index];
    description.flags = 0;
    description.pixelformat = format.fourcc;
    put(description.description, sizeof description.description, format.description);
    return 0;
}

int V4l2Node::enumerate_size(v4l2_frmsizeenum& size) const {
    const auto is_it = [&](const Format& format) { return format.fourcc == size.pixel_format; };
    if (size.index > 0 || std::none_of(formats_.begin(), formats_.end(), is_it))
        return EINVAL;
    size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    size.discrete = {static_cast<std::uint32_t>(lab_.lab().sensor_px.x),
                     static_cast<std::uint32_t>(lab_.lab().sensor_px.y)};
    return 0;
}

// What is not offered becomes what is, as V4L2 asks for.
int V4l2Node::answer_format(unsigned long request, void* argument) {
    if (request == VIDIOC_ENUM_FMT)
        return enumerate_format(*static_cast<v4l2_fmtdesc*>(argument));
    if (request == VIDIOC_ENUM_FRAMESIZES)
        return enumerate_size(*static_cast<v4l2_frmsizeenum*>(argument));
    auto& asked = *static_cast<v4l2_format*>(argument);
    if (asked.type != kCapture)
        return EINVAL;
    std::size_t format = format_;
    if (request != VIDIOC_G_FMT) {
        format = 0;
        for (std::size_t k = 0; k < formats_.size(); ++k)
            if (formats_[k].fourcc == asked.fmt.pix.pixelformat)
                format = k;
    }
    if (request == VIDIOC_S_FMT) {
        if (buffers_ > 0)
            return EBUSY;
        format_ = format;
    }
    asked.fmt.pix = layout_of(formats_[format]);
    return 0;
}

int V4l2Node::query_control(v4l2_queryctrl& query) const {
    const bool is_next = (query.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
    const std::uint32_t id = query.id & V4L2_CTRL_ID_MASK;
    const Control* found = nullptr;
    for (const Control& control : controls_)
        if ((is_next ? control.id > id : control.id == id) &&
            (found == nullptr || control.id < found->id))
            found = &control;
    if (found == nullptr)
        return EINVAL;
    query = {};
    query.id = found->id;
    query.type = found->type;
    put(query.name, sizeof query.name, found->name);
    query.minimum = found->least;
    query.maximum = found->most;
    query.step = 1;
    query.default_value = found->value;
    return 0;
}

int V4l2Node::query_menu(v4l2_querymenu& menu) const {
    if (menu.id != V4L2_CID_EXPOSURE_AUTO ||
        (menu.index != V4L2_EXPOSURE_MANUAL && menu.index != V4L2_EXPOSURE_APERTURE_PRIORITY))
        return EINVAL;
    put(menu.name, sizeof menu.name,
        menu.index == V4L2_EXPOSURE_MANUAL ? "Manual Mode" : "Aperture Priority Mode");
    return 0;
}

int V4l2Node::control_value(std::uint32_t id) const {
    return std::find_if(controls_.begin(), controls_.end(),
                        [id](const Control& control) { return control.id == id; })
        ->value;
}

int V4l2Node::set_control(const v4l2_control& asked) {
    for (Control& control : controls_) {
        if (control.id != asked.id)
            continue;
        if (asked.value < control.least || asked.value > control.most)
            return ERANGE;
        control.value = asked.value;
        if (asked.id == kSubject)
            lab_.set_subject(static_cast<gige::Subject>(asked.value));
        if (asked.id == kTargetView)
            lab_.set_target_view(asked.value);
        if (asked.id == kShot)
            lab_.set_shot(static_cast<std::uint32_t>(asked.value));
        return 0;
    }
    return EINVAL;
}

int V4l2Node::answer_control(unsigned long request, void* argument) {
    if (request == VIDIOC_QUERYCTRL)
        return query_control(*static_cast<v4l2_queryctrl*>(argument));
    if (request == VIDIOC_QUERYMENU)
        return query_menu(*static_cast<v4l2_querymenu*>(argument));
    auto& control = *static_cast<v4l2_control*>(argument);
    return request == VIDIOC_S_CTRL ? set_control(control) : get_control(control);
}

int V4l2Node::get_control(v4l2_control& control) const {
    for (const Control& known : controls_)
        if (known.id == control.id) {
            control.value = known.value;
            return 0;
        }
    return EINVAL;
}

int V4l2Node::answer_controls(unsigned long request, UMockdevIoctlData* data) {
    auto& list = *reinterpret_cast<v4l2_ext_controls*>(data->data);
    if (list.count == 0)
        return 0;  // asks whether there are any
    const Handle<UMockdevIoctlData> behind(
        umockdev_ioctl_data_resolve(data, offsetof(v4l2_ext_controls, controls),
                                    list.count * sizeof(v4l2_ext_control), nullptr));
    if (!behind)
        return EFAULT;
    auto* controls = reinterpret_cast<v4l2_ext_control*>(behind->data);
    for (std::uint32_t k = 0; k < list.count; ++k) {
        v4l2_control control{controls[k].id, controls[k].value};
        const int failure =
            request == VIDIOC_G_EXT_CTRLS ? get_control(control) : set_control(control);
        if (failure != 0) {
            list.error_idx = k;
            return failure;
        }
        controls[k].value = control.value;
    }
    return 0;
}

void V4l2Node::unmap() {
    if (memory_ != nullptr)
        munmap(memory_, memory_bytes_);
    memory_ = nullptr;
}

std::size_t V4l2Node::slot_bytes() const {
    constexpr std::size_t kPage = 4096;
    return (layout_of(formats_[format_]).sizeimage + kPage - 1) / kPage * kPage;
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
    const Format& format = formats_[format_];
    const gige::Lab& lab = lab_.lab();
    const gige::FormatInfo info = *gige::format_info(static_cast<std::uint32_t>(format.pixels));
    const double exposure_us = kExposureUnit_us * control_value(V4L2_CID_EXPOSURE_ABSOLUTE);
    const std::vector<std::uint8_t> bytes =
        gige::pack(format.pixels,
                   gige::crop(lab_.expose(exposure_us, control_value(V4L2_CID_GAIN)), lab.sensor_px,
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
    const std::chrono::microseconds duration(
        lab_.is_fast() ? 0 : 100 * control_value(V4L2_CID_EXPOSURE_ABSOLUTE));
    if (now < begin_ + duration)
        return EAGAIN;
    empty_polls_left_ = faults.empty_polls;
    buffer.index = queued_.front();
    queued_.pop_front();
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.length = layout_of(formats_[format_]).sizeimage;
    expose_into(buffer);
    const steady_clock::time_point stamp =
        std::exchange(begin_, {}) - std::chrono::seconds(take(faults.stale_frames) ? 10 : 0);
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(stamp.time_since_epoch());
    buffer.timestamp = {us.count() / 1'000'000, us.count() % 1'000'000};
    buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE |
                   (take(faults.broken_frames) ? V4L2_BUF_FLAG_ERROR : 0);
    if (take(faults.short_frames))
        buffer.bytesused -= layout_of(formats_[format_]).bytesperline;
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
            buffer.length = layout_of(formats_[format_]).sizeimage;
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
