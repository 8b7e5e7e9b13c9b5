// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sample_data/gige/camera.h"
#include "sample_data/gige/gvsp.h"
#include "sample_data/gige/pacer.h"
#include "sample_data/gige/udp_socket.h"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

namespace nearfield::gige {

/// The stream's end: one thread sends frames in order and at the link's pace, and packets that are
/// asked for again in between. Keeps the last frames for that.
class Link {
  public:
    /// on_death: called once, by the sending thread, when Faults::die_after comes true.
    Link(const CameraOptions& options, std::function<void()> on_death);
    ~Link();
    Link(const Link&) = delete;
    Link& operator=(const Link&) = delete;

    std::uint16_t port() const { return socket_.port(); }
    /// Takes a frame; waits while two others wait already. Gives it its block id.
    void send(Block block);
    void resend(const ResendRequest& request);
    void send_test_packet(const Settings& settings);
    /// Drops what waits, ends the thread.
    void close();
    /// The link's part of the statistics.
    Statistics statistics() const;

  private:
    void run();
    void keep(Block block);
    void send_block(const Block& block);
    void send_what_was_asked_for();
    void send_again(const ResendRequest& request);
    void transmit(const Packet& packet, const Settings& settings);
    bool is_dropped(std::uint32_t packet_id) const;

    Faults faults_;
    std::function<void()> on_death_;
    UdpSocket socket_;
    Pacer pacer_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::atomic<bool> closed_ = false;
    std::atomic<bool> resend_waits_ = false;
    std::deque<Block> waiting_;
    std::deque<ResendRequest> requests_;
    Statistics statistics_;
    // Of the sending thread alone.
    std::deque<Block> sent_;  // the last ones, the newest at the end
    std::size_t kept_bytes_ = 0;
    std::uint32_t sent_of_newest_ = 0;  // its packets so far
    std::uint64_t block_count_ = 0;
    std::uint16_t next_id_ = 1;
    std::thread thread_;
};

}  // namespace nearfield::gige
