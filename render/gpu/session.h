// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/scene/scene.h"
#include "render/opening.h"
#include "render/options.h"
#include "render/report.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace nearfield::render::gpu {

/// The OpenGL renderer for one picture after another, in an OpenGL context of its own: lamps, the
/// scene, programs, shadow maps and targets of the last sizes stay where they are as long as they
/// hold. A picture has the same bits whatever was rendered before.
///
/// Belongs to the thread that made it, in which no other context may become current.
class Session {
  public:
    /// Throws Error as HeadlessContext.
    Session();
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// What render_gl gives. only: of the scene's luminaires, one that is on; the picture then
    /// holds its light alone, bit by bit its part of the picture of all (the layers of the others
    /// are black, and unmapped pixels are not counted). Throws Error as render_gl, and Stopped
    /// where call.hooks.is_stopped says so; the session may be used on after both.
    Rendered render(const Scene& scene,
                    const RenderOptions& options,
                    const Call& call,
                    std::optional<std::size_t> only = std::nullopt);

    /// Of textures and buffers that were ever made here.
    std::uint64_t allocated_bytes() const;

  private:
    struct Kept;
    std::unique_ptr<Kept> kept_;
};

}  // namespace nearfield::render::gpu
