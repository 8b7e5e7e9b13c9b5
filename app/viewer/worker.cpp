// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/worker.h"

#include "app/viewer/refine.h"
#include "formats/files/error.h"
#include "render/gpu/session.h"
#include "render/metrics.h"

#include <chrono>
#include <exception>
#include <utility>

namespace nearfield::viewer {
namespace {

constexpr int kTrialDivisor = 8;
constexpr double kDraft_s = 0.045;  // two of them within the tenth of a second that feels direct
// After a draft, before refining: what is in the middle of a drag would be given up at once, and
// the next draft would wait for that.
constexpr std::chrono::milliseconds kStill(150);

/// Every lamp that is lit now was so before, alike.
bool has_all_light(const Document& before, const Document& now) {
    for (const EditedLamp& lamp : now.lamps) {
        const EditedLamp* old = find_lamp(before, lamp.id);
        if (is_lit(lamp) && (old == nullptr || !is_lit(*old) || !is_alike(*old, lamp)))
            return false;
    }
    return true;
}

}  // namespace

bool is_lit_alike(const Request& a, const Request& b) {
    return a.document.scene == b.document.scene && a.size_px == b.size_px && a.dial == b.dial &&
           a.camera.world_from_camera == b.camera.world_from_camera &&
           a.camera.yfov_rad == b.camera.yfov_rad && has_all_light(a.document, b.document);
}

Worker::Worker(std::function<void()> wake) : wake_(std::move(wake)), thread_([this] { loop(); }) {}

Worker::~Worker() {
    {
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
        ++ticket_;
    }
    asked_.notify_one();
    thread_.join();
}

void Worker::show(Request request) {
    {
        const std::lock_guard lock(mutex_);
        wanted_ = std::move(request);
        ++ticket_;
    }
    asked_.notify_one();
}

void Worker::try_dials(Request request) {
    {
        const std::lock_guard lock(mutex_);
        dials_wanted_ = std::move(request);
        progress_.trials.clear();
        ++ticket_;
    }
    asked_.notify_one();
}

void Worker::render(Request request, std::function<void(render::Rendered)> use) {
    {
        const std::lock_guard lock(mutex_);
        whole_.push_back({std::move(request), std::move(use)});
        ++progress_.whole_left;
        ++ticket_;
    }
    asked_.notify_one();
}

Progress Worker::progress() const {
    const std::lock_guard lock(mutex_);
    return progress_;
}

void Worker::tell(const std::function<void(Progress&)>& change) {
    {
        const std::lock_guard lock(mutex_);
        change(progress_);
    }
    wake_();
}

bool Worker::is_superseded(int ticket) const {
    const std::lock_guard lock(mutex_);
    return ticket != ticket_;
}

/// Whether somebody waits for something other than whole pictures.
bool Worker::is_interrupted() const {
    const std::lock_guard lock(mutex_);
    return is_ending_ || wanted_ || dials_wanted_;
}

bool Worker::stays_wanted(int ticket) {
    std::unique_lock lock(mutex_);
    return !asked_.wait_for(lock, kStill, [&] { return is_ending_ || ticket != ticket_; });
}

struct Worker::Thread {
    explicit Thread(Worker& owner) : worker(owner) {}

    Worker& worker;
    render::gpu::Session session{};
    Refiner refiner{session};
    int draft_divisor = 8;
    std::optional<Request> last;  // taken up again after a whole picture or trials
    bool is_complete = false;     // of last

    void refine(const Request& request, int ticket);
    void try_dials(const Request& request, int ticket);
    void render_whole(const Whole& whole);
    /// Does it, or tells why not.
    void attempt(const std::function<void()>& work);
    void run(const Work& work);
};

void Worker::Thread::refine(const Request& request, int ticket) {
    std::vector<Quality> stages = stages_of(request.dial, draft_divisor);
    if (refiner.has(request, stages.back()))
        stages.erase(stages.begin(), stages.end() - 1);
    for (std::size_t k = 0; k < stages.size(); ++k) {
        const bool is_draft = k == 0 && stages.size() > 1;
        const auto is_stopped = [&] { return !is_draft && worker.is_superseded(ticket); };
        Frame frame = refiner.render(request, stages[k], is_stopped);
        if (is_draft && refiner.has_rendered())
            draft_divisor = next_draft_divisor(draft_divisor, frame.time_s, kDraft_s);
        is_complete = k + 1 == stages.size();
        worker.tell([&](Progress& progress) {
            progress.frame = std::make_shared<const Frame>(std::move(frame));
            progress.is_final = is_complete;
            progress.error.clear();
            progress.draft_divisor = draft_divisor;
        });
        if (is_draft ? !worker.stays_wanted(ticket) : worker.is_superseded(ticket))
            return;
    }
}

void Worker::Thread::try_dials(const Request& request, int ticket) {
    std::vector<DialTrial> trials(dials().size());
    std::vector<Mixed> pictures;
    for (std::size_t k = 0; k < trials.size(); ++k) {
        Quality quality = dials()[k].quality;
        quality.divisor = kTrialDivisor;
        Refiner fresh{session};
        const auto is_stopped = [&] { return worker.is_superseded(ticket); };
        // Once without the clock, so that programs and shadow maps are there; moves draw maps anew.
        fresh.render(request, quality, is_stopped);
        Refiner timed{session};
        const Frame frame = timed.render(request, quality, is_stopped);
        trials[k].time_s = frame.time_s * kTrialDivisor * kTrialDivisor;
        pictures.push_back(mix(frame, gains_of(frame, request.document)));
    }
    for (std::size_t k = 0; k < trials.size(); ++k) {
        trials[k].error_rel =
            render::relative_error(pictures[k].radiance, pictures.back().radiance).rms;
        trials[k].lab = render::lab_difference(pictures[k].radiance, pictures.back().radiance);
    }
    worker.tell([&](Progress& progress) { progress.trials = trials; });
}

void Worker::Thread::render_whole(const Whole& whole) {
    const Request& request = whole.request;
    Scene scene = edited_scene(request.document);
    scene.cameras.insert(scene.cameras.begin(), request.camera);
    render::RenderOptions options =
        options_of(dials()[static_cast<std::size_t>(request.dial)].quality, request.size_px);
    options.camera = request.camera.name;
    render::RenderHooks hooks;
    hooks.is_stopped = [this] { return worker.is_interrupted(); };
    try {
        whole.use(session.render(scene, options, render::begin_call(options, hooks)));
    } catch (const render::Stopped&) {
        const std::lock_guard lock(worker.mutex_);
        worker.whole_.push_front(whole);
        throw;
    }
}

/// What was asked for since the last time.
struct Worker::Work {
    std::optional<Request> shown, dials;
    std::optional<Whole> whole;
    int ticket = 0;
};

std::optional<Worker::Work> Worker::wait_for_work() {
    std::unique_lock lock(mutex_);
    asked_.wait(lock, [this] { return is_ending_ || wanted_ || dials_wanted_ || !whole_.empty(); });
    if (is_ending_)
        return std::nullopt;
    Work work{std::exchange(wanted_, std::nullopt), std::exchange(dials_wanted_, std::nullopt),
              std::nullopt, ticket_};
    if (!work.shown && !work.dials && !whole_.empty()) {
        work.whole = std::move(whole_.front());
        whole_.pop_front();
    }
    return work;
}

void Worker::Thread::attempt(const std::function<void()>& work) {
    std::string why;
    try {
        work();
        return;
    } catch (const render::Stopped&) {
        return;  // the newest request is waiting
    } catch (const std::exception& error) {
        why = error.what();
    }
    is_complete = true;  // trying again would fail again
    worker.tell([&](Progress& progress) {
        progress.error = why;
        progress.is_final = true;
    });
}

void Worker::Thread::run(const Work& work) {
    if (work.shown) {
        last = work.shown;
        is_complete = false;
    }
    if (work.whole) {
        attempt([&] { render_whole(*work.whole); });
        int left = 0;
        worker.tell([&](Progress& progress) {
            progress.whole_left = left = static_cast<int>(worker.whole_.size());
        });
        if (left > 0)
            return;
    }
    if (work.dials)
        attempt([&] { try_dials(*work.dials, work.ticket); });
    // Also what trials and whole pictures have interrupted.
    if (last && !is_complete)
        attempt([&] { refine(*last, work.ticket); });
}

void Worker::loop() {
    std::optional<Thread> thread;
    while (const std::optional<Work> work = wait_for_work()) {
        try {
            if (!thread)
                thread.emplace(*this);
        } catch (const Error& error) {  // no OpenGL
            tell([&](Progress& progress) {
                progress.error = error.what();
                progress.is_final = true;
            });
            continue;
        }
        thread->run(*work);
    }
}

}  // namespace nearfield::viewer
