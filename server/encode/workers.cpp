#include "server/encode/workers.h"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

namespace brume {

EncodeWorkers::EncodeWorkers(unsigned threads) {
    try {
        for (unsigned i = 0; i < std::max(threads, 1u); ++i) threads_.emplace_back([this] { work(); });
    } catch (...) { // no more threads can be started: those that run are waited for
        stop();
        throw;
    }
}

EncodeWorkers::~EncodeWorkers() { stop(); }

void EncodeWorkers::stop() {
    {
        const std::scoped_lock lock(mutex_);
        stopping_ = true;
    }
    wake_.notify_all();
    threads_.clear(); // joins
}

void EncodeWorkers::give(Job job) {
    {
        const std::scoped_lock lock(mutex_);
        jobs_.push_back(std::move(job));
    }
    wake_.notify_one();
}

void EncodeWorkers::giveBack() {
    {
        const std::scoped_lock lock(mutex_);
        ++asked_;
    }
    wake_.notify_all();
}

void EncodeWorkers::work() {
    JpegEncoder encoder;
    uint64_t counted = 0, done = 0; // bytes of this thread in bytes_; asked_ when memory was given back last
    const auto count = [&] { bytes_ += encoder.bytes() - std::exchange(counted, encoder.bytes()); };
    std::unique_lock lock(mutex_);
    for (;;) {
        wake_.wait(lock, [&] { return stopping_ || !jobs_.empty() || done != asked_; });
        if (done != asked_) {
            done = asked_;
            encoder.giveBack();
            count();
            continue;
        }
        if (jobs_.empty()) return;
        const Job job = std::move(jobs_.front());
        jobs_.pop_front();
        lock.unlock();
        try {
            job(encoder);
        } catch (const std::exception& e) {
            spdlog::error("a picture is lost: {}", e.what());
        }
        count();
        lock.lock();
    }
}

} // namespace brume
