// Ctrl-C and SIGTERM as a flag that a program reads, so that it can end in good order.
#pragma once

namespace brume::client {

// While it exists, SIGINT and SIGTERM do not end the program. Create it before any thread.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    // True once a signal has come.
    bool asked();

private:
    int fd_;
    bool asked_ = false;
};

} // namespace brume::client
