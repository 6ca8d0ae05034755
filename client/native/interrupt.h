// Ctrl-C and SIGTERM as something to ask for, so that a program ends where it can end tidily.
#pragma once

namespace brume::client {

// From its construction on, SIGINT and SIGTERM no longer end the program. Make it before any thread.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    // True from the first signal on.
    bool asked();

private:
    int fd_;
    bool asked_ = false;
};

} // namespace brume::client
