// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::render::gpu {

/// What one pass took.
struct PassCost {
    std::string name;
    double time_s = 0;
    std::uint64_t bytes = 0;  // of textures and buffers that it allocated
};

/// The OpenGL context that is current in this thread (headless or a window's), its limits, and what
/// its driver says. One per context; must be destroyed before it.
class Device {
  public:
    Device();
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    /// "llvmpipe (LLVM 15.0.6, 256 bits)".
    const std::string& renderer() const { return renderer_; }
    /// Whether it is a rasterizer on the CPU: its memory is the machine's, and its timers lie.
    bool is_on_cpu() const { return is_on_cpu_; }
    int max_texture_px() const { return max_texture_px_; }
    int max_layers() const { return max_layers_; }
    /// Of a buffer that a shader reads.
    std::uint64_t max_buffer_bytes() const { return max_buffer_bytes_; }

    /// Runs a pass and adds to costs() what it took: by timer queries, or where those lie
    /// (rasterizers on the CPU answer before the work is done) by the clock around a glFinish.
    /// Throws Error naming the pass and what the driver said, if it reported an error (out of
    /// memory included).
    void run_pass(const std::string& name, const std::function<void()>& pass);
    const std::vector<PassCost>& costs() const { return costs_; }
    void clear_costs() { costs_.clear(); }
    /// Of all textures and buffers that were made by storage.h so far.
    std::uint64_t allocated_bytes() const { return allocated_bytes_; }
    void count_allocation(std::uint64_t bytes) { allocated_bytes_ += bytes; }

    /// From now on continue_or_stop() and run_pass() ask it, in this thread; empty: nothing is
    /// asked.
    void set_stop(std::function<bool()> is_stopped) { is_stopped_ = std::move(is_stopped); }
    bool can_be_stopped() const { return static_cast<bool>(is_stopped_); }
    /// Throws Stopped (render/report.h) where what was set says so.
    void continue_or_stop() const;

    /// Throws Error if the driver reported one since the last call.
    void check(const std::string& pass);

    /// Before `bytes` are asked of the driver: throws Error where its memory is the machine's (it
    /// renders on the CPU) and there is less, since it might be killed for it later.
    void check_room(const std::string& what, std::uint64_t bytes) const;
    /// After: throws Error if the driver had no room for them, or reported any other error.
    void check_allocation(const std::string& what, std::uint64_t bytes);

  private:
    std::string place_of(const std::string& what) const;
    /// The error and the driver's message, which are forgotten.
    std::string said(unsigned error);

    std::string renderer_;
    int max_texture_px_ = 0, max_layers_ = 0;
    std::uint64_t max_buffer_bytes_ = 0;
    bool is_on_cpu_ = false;
    std::function<bool()> is_stopped_;
    std::string pass_;  // that runs; empty: none
    std::vector<PassCost> costs_;
    std::uint64_t allocated_bytes_ = 0;
    std::string message_;  // the driver's first error since the last check
};

}  // namespace nearfield::render::gpu
