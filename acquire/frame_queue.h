// SPDX-License-Identifier: Apache-2.0
/// Writes frames while the camera exposes the next ones.
#pragma once

#include "formats/capture/capture.h"

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

namespace nearfield::acquire {

/// A bounded queue in front of a capture's writer: order is kept, memory is that of a few frames
/// however long the plan. Not for more than one thread that adds.
class FrameQueue {
  public:
    explicit FrameQueue(capture::CaptureWriter& writer);
    /// Writes what was added, unless a write failed.
    ~FrameQueue();
    FrameQueue(const FrameQueue&) = delete;
    FrameQueue& operator=(const FrameQueue&) = delete;

    /// Waits while the queue is full. Throws what an earlier write threw (disk full).
    void add(capture::Frame frame, capture::FrameRecord record);
    /// Waits until all is on disk. Throws what a write threw.
    void flush();

  private:
    void write_all();

    capture::CaptureWriter& writer_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::pair<capture::Frame, capture::FrameRecord>> waiting_;
    bool is_writing_ = false, is_ending_ = false;
    std::exception_ptr failure_;
    std::thread thread_;
};

}  // namespace nearfield::acquire
