// SPDX-License-Identifier: Apache-2.0
#include "sample_data/gige/link.h"

#include "sample_data/random.h"

#include <sys/prctl.h>

#include <algorithm>
#include <utility>

namespace nearfield::gige {
namespace {

constexpr std::size_t kMostWaiting = 2, kMostRequests = 4096;
constexpr std::size_t kKeptBytes = 64 << 20;  // half a second of a gigabit link

Peer destination(const Settings& settings) {
    return {settings.destination_ip, settings.destination_port};
}

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

Link::Link(const CameraOptions& options, std::function<void()> on_death)
    : faults_(options.faults),
      on_death_(std::move(on_death)),
      socket_(parse_ip(options.address), 0, "cannot open camera's stream") {
    if (options.link_mbit_s > 0)
        pacer_.ns_per_byte = 8000 / options.link_mbit_s;
    thread_ = std::thread([this] { run(); });
}

Link::~Link() {
    close();
    thread_.join();
}

void Link::close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
}

Statistics Link::statistics() const {
    const std::lock_guard lock(mutex_);
    return statistics_;
}

void Link::send(Block block) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || waiting_.size() < kMostWaiting; });
    block.id = std::exchange(next_id_, next_block_id(next_id_));
    waiting_.push_back(std::move(block));
    changed_.notify_all();
}

void Link::resend(const ResendRequest& request) {
    const std::lock_guard lock(mutex_);
    if (requests_.size() >= kMostRequests)
        return;
    requests_.push_back(request);
    resend_waits_ = true;
    changed_.notify_all();
}

void Link::send_test_packet(const Settings& settings) {
    socket_.set_do_not_fragment(settings.do_not_fragment);
    socket_.send(test_packet(settings.packet_bytes), destination(settings));
}

void Link::run() {
    prctl(PR_SET_TIMERSLACK, 1000);  // ns; the usual 50 us are a packet's time
    std::unique_lock lock(mutex_);
    while (!closed_) {
        if (resend_waits_) {
            lock.unlock();
            send_what_was_asked_for();
            lock.lock();
        } else if (!waiting_.empty()) {
            keep(std::move(waiting_.front()));
            lock.unlock();
            send_block(sent_.back());
            lock.lock();
            waiting_.pop_front();  // now only: what is being sent counts as waiting
            changed_.notify_all();
        } else {
            changed_.wait(lock);
        }
    }
}

void Link::keep(Block block) {
    kept_bytes_ += block.payload.size();
    sent_.push_back(std::move(block));
    while (kept_bytes_ > kKeptBytes && sent_.size() > 2) {
        kept_bytes_ -= sent_.front().payload.size();
        sent_.pop_front();
    }
}

// The same packets of the same frames whatever else happens.
bool Link::is_dropped(std::uint32_t packet_id) const {
    if (faults_.drop_share == 0)
        return false;
    sample_data::SplitMix hash{faults_.seed ^ block_count_ << 32U ^ packet_id};
    hash.next();
    return hash.next() < faults_.drop_share;
}

void Link::transmit(const Packet& packet, const Settings& settings) {
    pacer_.wait(packet.bytes() + kIpUdpBytes, settings.packet_delay_ns);
    socket_.send(packet, destination(settings));
}

void Link::send_block(const Block& block) {
    const Clock::time_point start = Clock::now();
    const Settings& settings = block.settings;
    ++block_count_;
    sent_of_newest_ = 0;
    if (settings.destination_port == 0 ||
        (faults_.stall_after > 0 && block_count_ > faults_.stall_after))
        return;
    const bool dies = faults_.die_after > 0 && block_count_ > faults_.die_after;
    socket_.set_do_not_fragment(settings.do_not_fragment);
    Statistics now;
    for (std::uint32_t k = 0; k < block.packets() && !closed_; ++k) {
        if (dies && k >= block.packets() / 2) {
            close();
            on_death_();
            return;
        }
        const bool is_data = k > 0 && k + 1 < block.packets();
        if (is_data && is_dropped(k)) {
            ++now.dropped_packets;
        } else {
            transmit(packet_of(block, k, false), settings);
            ++now.packets;
        }
        sent_of_newest_ = k + 1;
        send_what_was_asked_for();
    }
    const std::lock_guard lock(mutex_);
    ++statistics_.frames;
    statistics_.packets += now.packets;
    statistics_.dropped_packets += now.dropped_packets;
    statistics_.bytes += block.payload.size();
    statistics_.sending_s += seconds_since(start);
}

void Link::send_what_was_asked_for() {
    while (resend_waits_ && !closed_) {
        std::unique_lock lock(mutex_);
        const ResendRequest request = requests_.front();
        requests_.pop_front();
        resend_waits_ = !requests_.empty();
        lock.unlock();
        send_again(request);
    }
}

void Link::send_again(const ResendRequest& request) {
    if (faults_.no_resend || sent_.empty())
        return;
    const auto found = std::find_if(sent_.rbegin(), sent_.rend(), [&](const Block& block) {
        return block.id == request.block_id;
    });
    Statistics now;
    if (found == sent_.rend()) {
        const Settings& settings = sent_.back().settings;
        transmit(unavailable_packet(request.block_id, request.first_packet), settings);
        ++now.unavailable_packets;
    } else {
        // What has not been sent yet will be.
        const std::uint32_t end = found == sent_.rbegin() ? sent_of_newest_ : found->packets();
        for (std::uint32_t k = request.first_packet; k < end && k <= request.last_packet; ++k) {
            transmit(packet_of(*found, k, true), found->settings);
            ++now.resent_packets;
        }
    }
    const std::lock_guard lock(mutex_);
    statistics_.resent_packets += now.resent_packets;
    statistics_.unavailable_packets += now.unavailable_packets;
}

}  // namespace nearfield::gige
