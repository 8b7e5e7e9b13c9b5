// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

namespace nearfield::render::gpu {

/// An OpenGL 4.5 core context without window or display (EGL, surfaceless; Mesa and NVIDIA),
/// current in the thread that made it until it is destroyed there.
class HeadlessContext {
  public:
    /// Throws Error saying which step failed and what to install where there is no such context.
    HeadlessContext();
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

  private:
    struct Egl;
    std::unique_ptr<Egl> egl_;
};

}  // namespace nearfield::render::gpu
