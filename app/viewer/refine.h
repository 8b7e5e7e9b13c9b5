// SPDX-License-Identifier: Apache-2.0
/// A request's light at one quality: what changed is rendered, lamp by lamp; what did not is kept.
#pragma once

#include "app/viewer/light.h"
#include "render/gpu/session.h"

#include <functional>
#include <map>
#include <memory>
#include <vector>

namespace nearfield::viewer {

struct Request;

class Refiner {
  public:
    explicit Refiner(render::gpu::Session& session) : session_(session) {}

    /// Throws render::Stopped where is_stopped says so, and Error as the renderer; lamps that were
    /// finished are kept.
    Frame render(const Request& request,
                 const Quality& quality,
                 const std::function<bool()>& is_stopped);

    /// Whether render() would have nothing to do.
    bool has(const Request& request, const Quality& quality) const;

    /// Whether the last render() rendered anything.
    bool has_rendered() const { return has_rendered_; }

  private:
    /// A view at one quality, and its lamps.
    struct Kept {
        std::shared_ptr<const Scene> scene;
        Camera camera;
        Quality quality;
        glm::ivec2 size_px{0};
        Frame frame;                         // its lamps: see below
        std::map<int, EditedLamp> rendered;  // by id, as they were
        std::map<int, std::shared_ptr<const LampLight>> lights;
    };

    Kept& keep(const Request& request, const Quality& quality);
    const Kept* find(const Request& request, const Quality& quality) const;
    void render_lamp(const Scene& scene,
                     std::optional<std::size_t> lamp,
                     const Request& request,
                     const render::RenderHooks& hooks,
                     Kept& kept);

    render::gpu::Session& session_;
    std::vector<std::unique_ptr<Kept>> kept_;  // the last used first
    bool has_rendered_ = false;
};

}  // namespace nearfield::viewer
