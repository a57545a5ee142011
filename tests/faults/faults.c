// Preloaded into a program: makes its k-th call of a kind fail, counting over all processes that it
// starts. The environment selects the calls:
//   FAULT_UNDER   only calls on files below this folder count
//   FAULT_KIND    write, sync, rename or open (for writing)
//   FAULT_ERROR   the errno; 0: a write takes only half of its bytes
//   FAULT_FROM, FAULT_TO   the first and the last call that fails, from 1 on
//   FAULT_COUNT   a file of 8 bytes: the calls so far
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

static const char *under, *kind;
static size_t under_length;
static int error;
static long first, last;
static atomic_long *calls;

__attribute__((constructor)) static void begin(void) {
  const char *count = getenv("FAULT_COUNT");
  if (count == NULL) return;
  const int file = (int)syscall(SYS_openat, AT_FDCWD, count, O_RDWR | O_CLOEXEC, 0);
  void *const page = mmap(NULL, sizeof *calls, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  if (page == MAP_FAILED) abort();
  kind = getenv("FAULT_KIND");
  under = getenv("FAULT_UNDER");
  under_length = strlen(under);
  error = atoi(getenv("FAULT_ERROR"));
  first = atol(getenv("FAULT_FROM"));
  last = atol(getenv("FAULT_TO"));
  calls = page;
}

// True if a call of this kind must fail.
static int hit(const char *which) {
  if (calls == NULL || strcmp(which, kind) != 0) return 0;
  const long number = atomic_fetch_add(calls, 1) + 1;
  if (number < first || number > last) return 0;
  if (error != 0) errno = error;
  return 1;
}

// Includes the folder itself, which is synced.
static int below(const char *path) {
  return path[0] != '/' || strncmp(path, under, under_length) == 0 ||
         (strlen(path) + 1 == under_length && strncmp(path, under, under_length - 1) == 0);
}

static int hit_file(const char *which, int descriptor) {
  if (calls == NULL || strcmp(which, kind) != 0) return 0;
  char link[32], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const int before = errno;
  const ssize_t length = readlink(link, path, sizeof path - 1);
  errno = before;
  if (length < 0) return 0;
  path[length] = '\0';
  return path[0] == '/' && below(path) && hit(which);
}

static int hit_path(const char *which, const char *path) { return calls != NULL && below(path) && hit(which); }

#define REAL(name) ((__typeof__(&(name)))dlsym(RTLD_NEXT, #name))

// A selected write: fails, or takes half.
#define WRITE(call, half) (hit_file("write", descriptor) ? (error != 0 ? -1 : (half)) : (call))

ssize_t write(int descriptor, const void *bytes, size_t size) {
  return WRITE(syscall(SYS_write, descriptor, bytes, size), syscall(SYS_write, descriptor, bytes, (size + 1) / 2));
}
ssize_t pwrite(int descriptor, const void *bytes, size_t size, off_t at) {
  return WRITE(syscall(SYS_pwrite64, descriptor, bytes, size, at), syscall(SYS_pwrite64, descriptor, bytes, (size + 1) / 2, at));
}
ssize_t pwrite64(int descriptor, const void *bytes, size_t size, off_t at) { return pwrite(descriptor, bytes, size, at); }
ssize_t writev(int descriptor, const struct iovec *parts, int count) {
  return WRITE(syscall(SYS_writev, descriptor, parts, count),
               syscall(SYS_write, descriptor, parts[0].iov_base, (parts[0].iov_len + 1) / 2));
}
int ftruncate(int descriptor, off_t size) {
  return error != 0 && error != EINTR && hit_file("write", descriptor) ? -1 : (int)syscall(SYS_ftruncate, descriptor, size);
}
int ftruncate64(int descriptor, off_t size) { return ftruncate(descriptor, size); }

int fsync(int descriptor) { return hit_file("sync", descriptor) ? -1 : (int)syscall(SYS_fsync, descriptor); }
int fdatasync(int descriptor) { return hit_file("sync", descriptor) ? -1 : (int)syscall(SYS_fdatasync, descriptor); }

int rename(const char *from, const char *to) {
  return hit_path("rename", to) ? -1 : (int)syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to);
}
int renameat(int in, const char *from, int into, const char *to) {
  return hit_path("rename", to) ? -1 : (int)syscall(SYS_renameat, in, from, into, to);
}

static int opened(int folder, const char *path, int flags, va_list more) {
  const mode_t mode = (flags & (O_CREAT | __O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  if ((flags & (O_WRONLY | O_RDWR | O_CREAT)) != 0 && hit_path("open", path)) return -1;
  return (int)syscall(SYS_openat, folder, path, flags, mode);
}
#define OPEN(name, ...)                       \
  int name(__VA_ARGS__ const char *path, int flags, ...) { \
    va_list more;                             \
    va_start(more, flags);                    \
    const int result = opened(FOLDER, path, flags, more); \
    va_end(more);                             \
    return result;                            \
  }
#define FOLDER AT_FDCWD
OPEN(open, )
OPEN(open64, )
#undef FOLDER
#define FOLDER folder
OPEN(openat, int folder, )
OPEN(openat64, int folder, )

FILE *fopen(const char *path, const char *mode) {
  return mode[0] != 'r' && hit_path("open", path) ? NULL : REAL(fopen)(path, mode);
}
FILE *fopen64(const char *path, const char *mode) {
  return mode[0] != 'r' && hit_path("open", path) ? NULL : REAL(fopen64)(path, mode);
}
int mkdir(const char *path, mode_t mode) { return hit_path("open", path) ? -1 : (int)syscall(SYS_mkdirat, AT_FDCWD, path, mode); }
