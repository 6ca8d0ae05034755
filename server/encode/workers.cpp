#include "server/encode/workers.h"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

namespace brume {

EncodeWorkers::EncodeWorkers(unsigned threads) {
    for (unsigned i = 0; i < std::max(threads, 1u); ++i) threads_.emplace_back([this] { work(); });
}

EncodeWorkers::~EncodeWorkers() {
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

void EncodeWorkers::work() {
    JpegEncoder encoder;
    std::unique_lock lock(mutex_);
    for (;;) {
        wake_.wait(lock, [&] { return stopping_ || !jobs_.empty(); });
        if (jobs_.empty()) return;
        const Job job = std::move(jobs_.front());
        jobs_.pop_front();
        lock.unlock();
        try {
            job(encoder);
        } catch (const std::exception& e) {
            spdlog::error("a picture is lost: {}", e.what());
        }
        lock.lock();
    }
}

} // namespace brume
