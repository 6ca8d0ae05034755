#include "client/native/interrupt.h"

#include <cerrno>
#include <csignal>
#include <system_error>

#include <sys/signalfd.h>
#include <unistd.h>

namespace brume::client {

Interrupt::Interrupt() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    fd_ = signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
    if (fd_ < 0) throw std::system_error(errno, std::generic_category(), "cannot listen for signals");
}

Interrupt::~Interrupt() { ::close(fd_); }

bool Interrupt::asked() {
    signalfd_siginfo info;
    if (!asked_ && ::read(fd_, &info, sizeof info) == sizeof info) asked_ = true;
    return asked_;
}

} // namespace brume::client
