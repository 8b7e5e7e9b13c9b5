// SPDX-License-Identifier: Apache-2.0
/// The renderer's thread: the interface asks, goes on, and is woken when there is something to
/// show.
#pragma once

#include "app/viewer/light.h"
#include "app/viewer/quality.h"

#include <glm/glm.hpp>

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace nearfield::viewer {

/// What is to be seen.
struct Request {
    Document document;
    Camera camera;
    glm::ivec2 size_px{0};
    int dial = kDefaultDial;
    int serial = 0;  // the asker's; comes back with every frame
};

/// Whether frames of one serve the other, but for how lamps are mixed: neither dims above 0, nor
/// tints, nor lamps that are off now count.
bool is_lit_alike(const Request& a, const Request& b);

/// What a dial's position costs and gives, by trial at an eighth of the size.
struct DialTrial {
    double time_s = 0;     // of the whole picture: the trial's, by pixels
    double error_rel = 0;  // relative RMS of radiance against the dial's last position
    double lab = 0;
};

/// What the thread has done so far.
struct Progress {
    std::shared_ptr<const Frame> frame;  // the last; null before the first
    bool is_final = false;               // of the last request
    std::string error;                   // why there is no newer one; empty: none
    std::string device;                  // OpenGL's name
    std::vector<DialTrial> trials;       // by dial; empty: none asked for, or not yet done
    int draft_divisor = 8;
    int whole_left = 0;  // whole pictures that are to be rendered
};

class Worker {
  public:
    /// wake: called from the thread whenever progress() changes.
    explicit Worker(std::function<void()> wake);
    /// Gives up what is running.
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    /// From any thread. A draft that has begun is finished, so that drags show; all else is given
    /// up for the newest request.
    void show(Request request);
    /// Fills Progress::trials for what is shown.
    void try_dials(Request request);
    /// Renders a whole picture, as `nearfield render --device gl` does, and hands it on in the
    /// thread; one after the other, and begun again where something else was asked for in between.
    /// After them the last request is taken up again. Errors go to Progress::error.
    void render(Request request, std::function<void(render::Rendered)> use);
    Progress progress() const;

  private:
    struct Work;
    struct Whole {
        Request request;
        std::function<void(render::Rendered)> use;
    };
    struct Thread;  // what lives in the thread
    std::optional<Work> wait_for_work();
    void loop();
    void tell(const std::function<void(Progress&)>& change);
    bool is_superseded(int ticket) const;
    bool is_interrupted() const;
    /// Waits a moment: whether nothing else is asked for in it.
    bool stays_wanted(int ticket);

    std::function<void()> wake_;
    mutable std::mutex mutex_;
    std::condition_variable asked_;
    std::optional<Request> wanted_, dials_wanted_;
    std::deque<Whole> whole_;
    int ticket_ = 0;  // rises with every request
    bool is_ending_ = false;
    Progress progress_;
    std::thread thread_;
};

}  // namespace nearfield::viewer
