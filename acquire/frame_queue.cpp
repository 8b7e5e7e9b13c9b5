// SPDX-License-Identifier: Apache-2.0
#include "acquire/frame_queue.h"

#include <utility>

namespace nearfield::acquire {
namespace {

constexpr std::size_t kMostWaiting = 4;  // frames: evens out a slow write without filling memory

}  // namespace

FrameQueue::FrameQueue(capture::CaptureWriter& writer) : writer_(writer) {
    thread_ = std::thread([this] { write_all(); });
}

FrameQueue::~FrameQueue() {
    {
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void FrameQueue::add(capture::Frame frame, capture::FrameRecord record) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_.size() < kMostWaiting || failure_; });
    if (failure_)
        std::rethrow_exception(failure_);
    waiting_.emplace_back(std::move(frame), std::move(record));
    changed_.notify_all();
}

void FrameQueue::flush() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return (waiting_.empty() && !is_writing_) || failure_; });
    if (failure_)
        std::rethrow_exception(failure_);
}

void FrameQueue::write_all() {
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [this] { return !waiting_.empty() || is_ending_; });
        if (waiting_.empty() || failure_)
            return;
        auto [frame, record] = std::move(waiting_.front());
        waiting_.pop_front();
        is_writing_ = true;
        lock.unlock();
        std::exception_ptr failure;
        try {
            writer_.add(frame, std::move(record));
        } catch (...) {
            failure = std::current_exception();
        }
        lock.lock();
        is_writing_ = false;
        failure_ = failure;
        changed_.notify_all();
    }
}

}  // namespace nearfield::acquire
