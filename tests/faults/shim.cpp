// For tests alone, by LD_PRELOAD: the n-th call of a kind fails, as on a full disk, with too many open files,
// no process or no memory left. RASTERSLAM_FAULT=KIND:N:MARK, KIND one of write, open, rename, fork, memory;
// counted from the start of main() on. When it fails a call, the file MARK is made. Processes that the
// program starts are left alone, unless KIND ends by '+'.
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

enum class Kind { kNone, kWrite, kOpen, kRename, kFork, kMemory };

Kind wanted = Kind::kNone;
long wanted_call = 0;
char mark[4096];
std::atomic<long> calls{0};
std::atomic<bool> counting{false};

/// Whether this call is the one to fail.
bool fails(Kind kind, int error) {
  if (!counting.load(std::memory_order_relaxed) || kind != wanted || ++calls != wanted_call) return false;
  const long file = syscall(SYS_openat, AT_FDCWD, mark, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file >= 0) syscall(SYS_close, file);
  errno = error;
  return true;
}

void readWish() {
  const char* wish = getenv("RASTERSLAM_FAULT");
  if (wish == nullptr) return;
  const char* colon = strchr(wish, ':');
  if (colon == nullptr || colon == wish) return;
  const auto is = [&](const char* name) { return strncmp(wish, name, strlen(name)) == 0; };
  const bool with_children = colon[-1] == '+';
  wanted = is("write")    ? Kind::kWrite
           : is("open")   ? Kind::kOpen
           : is("rename") ? Kind::kRename
           : is("fork")   ? Kind::kFork
           : is("memory") ? Kind::kMemory
                          : Kind::kNone;
  char* end = nullptr;
  wanted_call = strtol(colon + 1, &end, 10);
  if (*end == ':') strncpy(mark, end + 1, sizeof mark - 1);
  if (!with_children) unsetenv("RASTERSLAM_FAULT");
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

int (*real_main)(int, char**, char**) = nullptr;

int countingMain(int argc, char** argv, char** environment) {
  counting = true;
  const int code = real_main(argc, argv, environment);
  counting = false;  // what ends the process is nobody's to handle
  return code;
}

// What dlsym(3) itself asks for before the real functions are known.
alignas(16) char early[65536];
std::size_t early_used = 0;

void* earlyMemory(std::size_t size) {
  early_used = (early_used + 15) & ~std::size_t{15};
  if (early_used + size > sizeof early) return nullptr;
  void* memory = early + early_used;
  early_used += size;
  return memory;
}

bool isEarly(const void* memory) {
  return memory >= early && memory < early + sizeof early;
}

bool resolving = false;

template <class Function>
Function realMemory(Function& function, const char* name) {
  if (function == nullptr && !resolving) {
    resolving = true;
    function = next<Function>(name);
    resolving = false;
  }
  return function;
}

void* (*real_malloc)(std::size_t) = nullptr;
void* (*real_calloc)(std::size_t, std::size_t) = nullptr;
void* (*real_realloc)(void*, std::size_t) = nullptr;
void* (*real_aligned)(std::size_t, std::size_t) = nullptr;
int (*real_posix)(void**, std::size_t, std::size_t) = nullptr;
void (*real_free)(void*) = nullptr;

}  // namespace

#define EXPORT extern "C" __attribute__((visibility("default")))

// NOLINTNEXTLINE(bugprone-reserved-identifier, readability-identifier-naming): as the C library calls it
EXPORT int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(),
                             void (*fini)(), void (*loader_fini)(), void* stack_end) {
  using Start = int (*)(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*);
  real_main = main;
  readWish();
  return next<Start>("__libc_start_main")(countingMain, argc, argv, init, fini, loader_fini, stack_end);
}

EXPORT ssize_t write(int file, const void* data, std::size_t size) {
  static const auto real = next<ssize_t (*)(int, const void*, std::size_t)>("write");
  return file > STDERR_FILENO && fails(Kind::kWrite, ENOSPC) ? -1 : real(file, data, size);
}
EXPORT ssize_t writev(int file, const iovec* parts, int count) {
  static const auto real = next<ssize_t (*)(int, const iovec*, int)>("writev");
  return file > STDERR_FILENO && fails(Kind::kWrite, ENOSPC) ? -1 : real(file, parts, count);
}
EXPORT std::size_t fwrite(const void* data, std::size_t size, std::size_t count, FILE* file) {
  static const auto real = next<std::size_t (*)(const void*, std::size_t, std::size_t, FILE*)>("fwrite");
  return file != stderr && file != stdout && fails(Kind::kWrite, ENOSPC) ? 0 : real(data, size, count, file);
}

#define OPEN(name)                                                        \
  EXPORT int name(const char* path, int flags, ...) {                     \
    static const auto real = next<int (*)(const char*, int, ...)>(#name); \
    va_list more;                                                         \
    va_start(more, flags);                                                \
    const mode_t mode = va_arg(more, mode_t);                             \
    va_end(more);                                                         \
    return fails(Kind::kOpen, EMFILE) ? -1 : real(path, flags, mode);     \
  }
OPEN(open)
OPEN(open64)
#define FOPEN(name)                                                            \
  EXPORT FILE* name(const char* path, const char* mode) {                      \
    static const auto real = next<FILE* (*)(const char*, const char*)>(#name); \
    return fails(Kind::kOpen, EMFILE) ? nullptr : real(path, mode);            \
  }
FOPEN(fopen)
FOPEN(fopen64)
EXPORT DIR* opendir(const char* path) {
  static const auto real = next<DIR* (*)(const char*)>("opendir");
  return fails(Kind::kOpen, EMFILE) ? nullptr : real(path);
}
EXPORT int mkdir(const char* path, mode_t mode) {
  static const auto real = next<int (*)(const char*, mode_t)>("mkdir");
  return fails(Kind::kOpen, ENOSPC) ? -1 : real(path, mode);
}

EXPORT int rename(const char* from, const char* to) {
  static const auto real = next<int (*)(const char*, const char*)>("rename");
  return fails(Kind::kRename, EIO) ? -1 : real(from, to);
}
EXPORT int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  static const auto real = next<int (*)(int, const char*, int, const char*, unsigned)>("renameat2");
  return fails(Kind::kRename, EIO) ? -1 : real(from_folder, from, to_folder, to, flags);
}

EXPORT pid_t fork() {
  static const auto real = next<pid_t (*)()>("fork");
  return fails(Kind::kFork, EAGAIN) ? -1 : real();
}
EXPORT int posix_spawn(pid_t* child, const char* path, const posix_spawn_file_actions_t* actions,
                       const posix_spawnattr_t* attributes, char* const argv[], char* const environment[]) {
  static const auto real =
      next<int (*)(pid_t*, const char*, const posix_spawn_file_actions_t*, const posix_spawnattr_t*,
                   char* const[], char* const[])>("posix_spawn");
  return fails(Kind::kFork, EAGAIN) ? EAGAIN : real(child, path, actions, attributes, argv, environment);
}
// NOLINTNEXTLINE(readability-identifier-naming): as the C library calls it
EXPORT int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*),
                          void* argument) {
  static const auto real =
      next<int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*)>("pthread_create");
  return fails(Kind::kFork, EAGAIN) ? EAGAIN : real(thread, attributes, work, argument);
}

EXPORT void* malloc(std::size_t size) {
  if (fails(Kind::kMemory, ENOMEM)) return nullptr;
  const auto real = realMemory(real_malloc, "malloc");
  return real == nullptr ? earlyMemory(size) : real(size);
}
EXPORT void* calloc(std::size_t count, std::size_t size) {
  if (fails(Kind::kMemory, ENOMEM)) return nullptr;
  const auto real = realMemory(real_calloc, "calloc");
  return real == nullptr ? earlyMemory(count * size) : real(count, size);
}
EXPORT void* realloc(void* memory, std::size_t size) {
  if (fails(Kind::kMemory, ENOMEM)) return nullptr;
  const auto real = realMemory(real_realloc, "realloc");
  if (!isEarly(memory) && real != nullptr) return real(memory, size);
  void* moved = malloc(size);
  if (moved != nullptr && memory != nullptr) memcpy(moved, memory, size);  // `early` has as much behind it
  return moved;
}
EXPORT void* aligned_alloc(std::size_t alignment, std::size_t size) {
  if (fails(Kind::kMemory, ENOMEM)) return nullptr;
  return realMemory(real_aligned, "aligned_alloc")(alignment, size);
}
EXPORT int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  if (fails(Kind::kMemory, ENOMEM)) return ENOMEM;
  return realMemory(real_posix, "posix_memalign")(memory, alignment, size);
}
EXPORT void free(void* memory) {
  if (memory == nullptr || isEarly(memory)) return;
  if (const auto real = realMemory(real_free, "free"); real != nullptr) real(memory);
}
