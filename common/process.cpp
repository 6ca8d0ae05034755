#include "common/process.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace brume {
namespace {

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

std::vector<std::string> environmentWith(const std::vector<std::string>& changes) {
    std::vector<std::string> all;
    for (char** entry = environ; *entry; ++entry) {
        const std::string text = *entry;
        const std::string name = text.substr(0, text.find('='));
        bool replaced = false;
        for (const auto& change : changes) replaced = replaced || change.substr(0, change.find('=')) == name;
        if (!replaced) all.push_back(text);
    }
    for (const auto& change : changes)
        if (change.find('=') != change.npos) all.push_back(change);
    return all;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> all;
    for (auto& text : texts) all.push_back(text.data());
    all.push_back(nullptr);
    return all;
}

} // namespace

Process::Process(const std::vector<std::string>& command, const std::vector<std::string>& environment,
                 std::function<void()> on_output)
    : on_output_(std::move(on_output)) {
    std::vector<std::string> arguments = command, variables = environmentWith(environment);
    const std::vector<char*> argv = pointers(arguments), envp = pointers(variables);
    std::array<int, 2> out{}, err{};
    if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(err.data(), O_CLOEXEC) != 0) fail("pipe");
    pid_ = fork();
    if (pid_ < 0) fail("fork");
    if (pid_ == 0) { // only what is safe between fork and exec
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        dup2(out[1], STDOUT_FILENO);
        dup2(err[1], STDERR_FILENO);
        close_range(STDERR_FILENO + 1, ~0U, 0); // a socket that listens, too: the child would keep its port
        execve(argv[0], argv.data(), envp.data());
        _exit(127);
    }
    close(out[1]);
    close(err[1]);
    reader_ = std::thread([this, from = out[0], from_err = err[0]] { read(from, from_err); });
}

Process::~Process() {
    if (!exit_code_) {
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    reader_.join();
}

void Process::read(int out, int err) {
    std::array<pollfd, 2> pipes{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
    std::array<char, 4096> buffer;
    while (pipes[0].fd >= 0 || pipes[1].fd >= 0) {
        poll(pipes.data(), pipes.size(), -1);
        for (size_t i = 0; i < pipes.size(); ++i) {
            if (pipes[i].fd < 0 || pipes[i].revents == 0) continue;
            const ssize_t size = ::read(pipes[i].fd, buffer.data(), buffer.size());
            if (size > 0) {
                const std::scoped_lock lock(mutex_);
                (i == 0 ? out_ : err_).append(buffer.data(), static_cast<size_t>(size));
            } else if (size == 0 || errno != EINTR) {
                close(pipes[i].fd);
                pipes[i].fd = -1; // poll passes over it
            }
            changed_.notify_all();
            if (size > 0 && on_output_) on_output_();
        }
    }
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
}

void Process::signal(int number) {
    if (!exit_code_) kill(pid_, number);
}

std::optional<int> Process::exitCode(milliseconds timeout) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (!exit_code_) {
        int status = 0;
        if (waitpid(pid_, &status, WNOHANG) == pid_) {
            exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
            std::unique_lock lock(mutex_);
            changed_.wait_for(lock, kPatience, [&] { return closed_; });
        } else if (std::chrono::steady_clock::now() >= deadline) {
            return {};
        } else {
            std::this_thread::sleep_for(milliseconds(5));
        }
    }
    return exit_code_;
}

std::optional<std::string> Process::lineStarting(const std::string& prefix, milliseconds timeout) {
    std::optional<std::string> found;
    const auto search = [&] {
        for (size_t begin = 0, end; (end = out_.find('\n', begin)) != out_.npos; begin = end + 1)
            if (out_.compare(begin, prefix.size(), prefix) == 0) {
                found = out_.substr(begin + prefix.size(), end - begin - prefix.size());
                return true;
            }
        return closed_;
    };
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, search);
    return found;
}

std::string Process::out() const {
    const std::scoped_lock lock(mutex_);
    return out_;
}

std::string Process::err() const {
    const std::scoped_lock lock(mutex_);
    return err_;
}

} // namespace brume
