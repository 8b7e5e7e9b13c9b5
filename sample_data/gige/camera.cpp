// SPDX-License-Identifier: Apache-2.0
#include "sample_data/gige/camera.h"

#include "formats/files/error.h"
#include "sample_data/gige/gvcp.h"
#include "sample_data/gige/link.h"
#include "sample_data/gige/udp_socket.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace nearfield::gige {
namespace {

using std::chrono::nanoseconds;

nanoseconds from_us(double us) {
    return nanoseconds(static_cast<std::int64_t>(us * 1000));
}

double to_s(nanoseconds time) {
    return std::chrono::duration<double>(time).count();
}

void require(bool good, const char* where, const char* expected, const std::string& got) {
    if (!good)
        throw Error("cannot open camera", where, expected, got);
}

void check_options(const CameraOptions& options, const Lab& lab) {
    const auto is_side = [](int side) { return side >= 2 && side <= 16384 && side % 2 == 0; };
    require(is_side(lab.sensor_px.x) && is_side(lab.sensor_px.y), "sensor size",
            "even numbers, 2 ... 16384", fmt::format("{} x {}", lab.sensor_px.x, lab.sensor_px.y));
    require(lab.sensor_bits >= 8 && lab.sensor_bits <= 16, "sensor bits", "8 ... 16",
            fmt::format("{}", lab.sensor_bits));
    require(lab.filter_grid.x > 0 && lab.filter_grid.y > 0 && lab.target_views >= 0,
            "filter grid and target views", "positive numbers",
            fmt::format("{} x {}, {}", lab.filter_grid.x, lab.filter_grid.y, lab.target_views));
    require(bool(lab.expose), "lab", "a callback that exposes", "none");
    require(options.serial.size() <= 15, "serial number", "15 characters at most", options.serial);
    require(options.exposure_latency_frames >= 0 && options.exposure_latency_frames <= 1000,
            "exposure latency", "0 ... 1000 frames",
            fmt::format("{}", options.exposure_latency_frames));
    require(options.readout_us >= 0 && options.readout_us <= 1e7, "readout", "0 ... 1e7 us",
            fmt::format("{}", options.readout_us));
    require(options.link_mbit_s >= 0 && options.link_mbit_s <= 1e6, "link", "0 ... 1e6 Mbit/s",
            fmt::format("{}", options.link_mbit_s));
    require(options.faults.drop_share >= 0 && options.faults.drop_share <= 1, "share of drops",
            "0 ... 1", fmt::format("{}", options.faults.drop_share));
}

// The lab's time: the clock's, and what exposures would have taken that did not.
class LabClock {
  public:
    nanoseconds now() const { return Clock::now() - start_ + nanoseconds(skipped_ns_.load()); }
    void skip(nanoseconds time) { skipped_ns_ += time.count(); }

  private:
    Clock::time_point start_ = Clock::now();
    std::atomic<std::int64_t> skipped_ns_ = 0;
};

// Exposure and gain as they are applied, faults and latency included.
class AppliedSettings {
  public:
    explicit AppliedSettings(const CameraOptions& options)
        : latency_(static_cast<std::size_t>(options.exposure_latency_frames)),
          faults_(options.faults) {}

    // What the next frame gets, where the registers say `asked`.
    Exposure next(const Settings& asked) {
        if (!first_us_)
            first_us_ = asked.exposure_us;
        history_.push_back({0, asked.exposure_us, asked.gain_db, 0, {}});
        if (history_.size() > latency_ + 1)
            history_.pop_front();
        Exposure applied = history_.front();
        if (faults_.ignore_exposure)
            applied.exposure_us = *first_us_;
        if (faults_.clamp_exposure_us > 0)
            applied.exposure_us = std::min(applied.exposure_us, faults_.clamp_exposure_us);
        applied.stage = asked.stage;
        if (std::exchange(shots_, asked.shots) != asked.shots)
            frame_number_ = 0;
        applied.frame_number = frame_number_++;
        return applied;
    }

  private:
    std::size_t latency_;
    Faults faults_;
    std::optional<double> first_us_;
    std::deque<Exposure> history_;
    std::uint64_t frame_number_ = 0, shots_ = 0;
};

// A frame whose exposure has begun.
struct Begun {
    Settings settings;
    Exposure exposure;
    std::uint64_t acquisition = 0;  // Acquisition::starts
    Clock::time_point start;
    nanoseconds lab_time{0};
};

}  // namespace

struct Camera::Threads {
    Threads(CameraOptions camera_options, Lab camera_lab);
    ~Threads();

    void end();
    void fail();
    void guard(void (Threads::*work)());
    void control();
    void answer_from(const UdpSocket& socket);
    bool is_for_us(Peer from, const UdpSocket& socket) const;
    void expose();
    std::optional<Begun> begin_frame();
    bool finish_exposure(const Begun& frame);
    Block block_of(const Begun& frame, std::span<const std::uint16_t> values) const;
    bool is_current(std::uint64_t acquisition) const;

    CameraOptions options;
    Lab lab;
    std::uint32_t ip;
    LabClock clock;
    UdpSocket commands;
    std::optional<UdpSocket> broadcasts;

    std::mutex mutex;  // of all below, down to `failure`
    std::condition_variable changed;
    Device device;
    Control privilege;
    Statistics statistics;
    std::exception_ptr failure;

    std::atomic<bool> ended = false;
    AppliedSettings applied;       // of the exposure thread
    Clock::time_point next_start;  // of the exposure thread
    std::uint64_t last_acquisition = 0;
    Link link;
    std::thread control_thread, exposure_thread;
};

Camera::Threads::Threads(CameraOptions camera_options, Lab camera_lab)
    : options(std::move(camera_options)),
      lab(std::move(camera_lab)),
      ip((check_options(options, lab), parse_ip(options.address))),
      commands(ip, options.port, "cannot open camera"),
      broadcasts(broadcast_socket(commands.port())),
      device(options, lab, [this] { return to_s(clock.now()); }),
      applied(options),
      link(options, [this] { end(); }) {
    device.set(address::kStreamSourcePort, link.port());
    control_thread = std::thread([this] { guard(&Threads::control); });
    exposure_thread = std::thread([this] { guard(&Threads::expose); });
}

Camera::Threads::~Threads() {
    end();
    link.close();
    control_thread.join();
    exposure_thread.join();
}

void Camera::Threads::end() {
    const std::lock_guard lock(mutex);
    ended = true;
    changed.notify_all();
}

// A callback's exception ends the camera; check() tells of it.
void Camera::Threads::guard(void (Threads::*work)()) {
    try {
        (this->*work)();
    } catch (...) {
        fail();
    }
}

void Camera::Threads::fail() {
    {
        const std::lock_guard lock(mutex);
        failure = std::current_exception();
    }
    end();
}

// A camera on the loopback address does not answer to the network around.
bool Camera::Threads::is_for_us(Peer from, const UdpSocket& socket) const {
    return &socket == &commands || !is_loopback(ip) || is_loopback(from.ip);
}

void Camera::Threads::answer_from(const UdpSocket& socket) {
    while (const auto received = socket.receive()) {
        const auto& [datagram, from] = *received;
        if (!is_for_us(from, socket))
            continue;
        Settings settings;
        bool test_packet_asked = false;
        Answer reply;
        {
            const std::lock_guard lock(mutex);
            reply = answer(device, privilege, datagram, from, Clock::now());
            ++statistics.commands;
            statistics.refused_commands += reply.is_refused ? 1 : 0;
            statistics.malformed_commands += reply.is_malformed ? 1 : 0;
            test_packet_asked = std::exchange(device.test_packet_asked, false);
            settings = device.settings();
            changed.notify_all();
        }
        if (!reply.datagram.empty())
            commands.send(reply.datagram, from);
        if (reply.resend)
            link.resend(*reply.resend);
        if (test_packet_asked)
            link.send_test_packet(settings);
    }
}

void Camera::Threads::control() {
    constexpr int kCheckMs = 50;  // for heartbeat and end
    std::array<pollfd, 2> events = {
        {{commands.file(), POLLIN, 0},
         {broadcasts ? broadcasts->file() : -1, POLLIN, 0}}};  // a negative one is skipped
    while (!ended) {
        poll(events.data(), events.size(), kCheckMs);
        answer_from(commands);
        if (broadcasts)
            answer_from(*broadcasts);
        const std::lock_guard lock(mutex);
        expire_control(device, privilege, Clock::now());
        changed.notify_all();
    }
}

bool Camera::Threads::is_current(std::uint64_t acquisition) const {
    return !ended && device.acquisition.active && device.acquisition.starts == acquisition;
}

// Waits for a frame's trigger or time; nothing when the camera ends.
std::optional<Begun> Camera::Threads::begin_frame() {
    std::unique_lock lock(mutex);
    while (!ended) {
        Acquisition& acquisition = device.acquisition;
        const Settings settings = device.settings();
        const Clock::time_point now = Clock::now();
        if (!acquisition.active || acquisition.frames_left == 0 ||
            (settings.is_triggered && acquisition.triggers == 0)) {
            changed.wait(lock);
        } else if (!settings.is_triggered && acquisition.starts == last_acquisition &&
                   now < next_start) {
            changed.wait_until(lock, next_start);
        } else {
            if (settings.is_triggered)
                --acquisition.triggers;
            --acquisition.frames_left;
            if (std::exchange(last_acquisition, acquisition.starts) != acquisition.starts)
                next_start = now;
            next_start = std::max(next_start, now - from_us(1e6 / settings.frame_rate_hz)) +
                         from_us(1e6 / settings.frame_rate_hz);
            Begun frame{settings, applied.next(settings), acquisition.starts, now, clock.now()};
            frame.exposure.time_s = to_s(frame.lab_time) + frame.exposure.exposure_us / 2e6;
            return frame;
        }
    }
    return std::nullopt;
}

// Waits until exposure and readout are over. False where the acquisition has been stopped
// meanwhile.
bool Camera::Threads::finish_exposure(const Begun& frame) {
    const nanoseconds duration = from_us(frame.exposure.exposure_us + options.readout_us);
    const Clock::time_point end = frame.start + duration;
    std::unique_lock lock(mutex);
    if (options.fast)
        clock.skip(std::max(nanoseconds(0), end - Clock::now()));
    else if (Clock::now() > end)
        ++statistics.late_frames;
    else
        changed.wait_until(lock, end, [&] { return !is_current(frame.acquisition); });
    const bool is_wanted = is_current(frame.acquisition);
    if (is_wanted && device.acquisition.frames_left == 0)
        device.stop();
    return is_wanted;
}

Block Camera::Threads::block_of(const Begun& frame, std::span<const std::uint16_t> values) const {
    const Settings& settings = frame.settings;
    const FormatInfo format = *format_info(static_cast<std::uint32_t>(settings.format));
    Block block;
    block.timestamp_ns = static_cast<std::uint64_t>(frame.lab_time.count());
    block.settings = settings;
    block.payload =
        pack(settings.format, crop(values, lab.sensor_px, settings.offset_px, settings.size_px,
                                   lab.sensor_bits, format.value_bits));
    return block;
}

void Camera::Threads::expose() {
    while (const auto frame = begin_frame()) {
        const std::vector<std::uint16_t> values = lab.expose(frame->exposure);
        if (values.size() !=
            static_cast<std::size_t>(lab.sensor_px.x) * static_cast<std::size_t>(lab.sensor_px.y))
            throw Error("cannot expose", "picture", "as many values as the sensor has pixels",
                        fmt::format("{}", values.size()));
        Block block = block_of(*frame, values);
        if (finish_exposure(*frame))
            link.send(std::move(block));
    }
}

void check_address(const CameraOptions& options) {
    const UdpSocket socket(parse_ip(options.address), options.port, "cannot open camera");
}

Camera::Camera(CameraOptions options, Lab lab)
    : threads_(std::make_unique<Threads>(std::move(options), std::move(lab))) {}

Camera::~Camera() = default;

std::uint16_t Camera::port() const {
    return threads_->commands.port();
}

bool Camera::running() const {
    return !threads_->ended;
}

void Camera::check() const {
    const std::lock_guard lock(threads_->mutex);
    if (threads_->failure)
        std::rethrow_exception(threads_->failure);
}

Statistics Camera::statistics() const {
    Statistics all = threads_->link.statistics();
    const std::lock_guard lock(threads_->mutex);
    all.late_frames = threads_->statistics.late_frames;
    all.commands = threads_->statistics.commands;
    all.refused_commands = threads_->statistics.refused_commands;
    all.malformed_commands = threads_->statistics.malformed_commands;
    return all;
}

}  // namespace nearfield::gige
