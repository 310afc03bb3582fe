/* bad.c - a tracker with one fault, chosen by -DFAULT=NAME; -DFROM=N keeps what is wrong in push for frame N and later.
   Without a fault it leaves every point where it is. */
#define _GNU_SOURCE
#include "honami.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

enum fault {
  NONE, NULL_RECORD, SMALL_RECORD, NULL_CREATE, OTHER_MANIFEST, NO_INSTANCE, NULL_FUNCTION, SMALL_INSTANCE, SMALL_TABLE,
  NULL_TABLE, OTHER_LATENCY, NAN_POSITION, UNKNOWN_ID, TWICE, NO_ROWS, FEWER, NEGATIVE, SILENT, OVERCOMMIT, COMMIT_ONLY,
  COMMIT_TWICE, PAST_THE_END, BAD_STATUS, BAD_QUALITY, WRONG_TYPE, MISSING_COLUMN, OTHER_SCHEMA, TOO_MUCH, PRINTS,
  UNASKED_CANCEL, AGAIN, SEED_RESULT, REFUSES_PARAMS, COMMIT_RESERVE_COMMIT,
  /* From here on in frame 2: */
  SEGFAULT, ABORTS, EXITS, LOOPS, SLEEPS, DEAF, FLOODS, ESCAPES, LEAKS, FORKS, SOCKET, FILES, WITHERS,
  READS_ON, WAITS, CONNECTS, SCRIBBLES, CALLS, SPEAKS,
  /* or before main: */
  CTOR_WRITES, CTOR_EXECS, CTOR_DIES
};

#ifndef FROM
#define FROM 0
#endif
/* From this frame on every point but the first is hidden. */
#ifndef HIDES
#define HIDES 1000
#endif
#ifndef KNOWN
#define KNOWN "\"honami\":1,\"abi\":[1,0],"
#endif
#define MANIFEST                                                                                            \
  "{" KNOWN "\"library\":{\"id\":\"org.honami.bad\",\"version\":\"0\"},\"plugins\":[{\"id\":\"org.honami.bad\"," \
  "\"kind\":\"tracker\",\"name\":\"Bad\",\"interfaces\":[\"honami.tracker/1\"]}]}"
#ifndef NO_NOTE
HONAMI_MANIFEST(MANIFEST);
#endif

/* The first n bytes of a struct, before a page that nobody may touch. */
static void *cut(const void *whole, size_t n) {
  size_t page = (size_t)sysconf(_SC_PAGESIZE);
  char *pages = mmap(NULL, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (pages == MAP_FAILED || mprotect(pages + page, page, PROT_NONE) != 0) abort();
  return memcpy(pages + page - n, whole, n);
}

#ifdef CONSTRUCTOR
static int written = -1;
__attribute__((constructor)) static void before_main(void) {
  char *const nothing[] = {NULL};
  if (FAULT == CTOR_WRITES) written = open(CONSTRUCTOR, O_CREAT | O_WRONLY, 0600);
  if (FAULT == CTOR_EXECS) execve("/bin/true", nothing, nothing);
  if (FAULT == CTOR_DIES) abort();
  (void)written;
}
#endif

#ifdef MISSING
int not_anywhere(void);
int (*uses_it)(void) = not_anywhere;
#endif

/* Whether anything outside can be reached through a local socket; a pair within the process does no harm. */
static int connects(void) {
  int pair[2];
  return socket(AF_UNIX, SOCK_STREAM, 0) >= 0 || socket(AF_UNIX, SOCK_DGRAM, 0) >= 0 ||
         socketpair(AF_UNIX, SOCK_DGRAM, 0, pair) == 0 || socketpair(AF_UNIX, SOCK_RAW, 0, pair) == 0 ||
         socketpair(AF_UNIX, SOCK_RAW | SOCK_CLOEXEC, 0, pair) == 0 ||
         socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) != 0 ||
         socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0;
}

/* The call under which this kernel does what a plugin must not; NULL when it does none of them. */
static const char *calls(void) {
  if (syscall(SYS_clone3, NULL, 0L) != -1 || errno != ENOSYS) return "clone3";
  if (syscall(SYS_clone, (long)(CLONE_NEWUSER | SIGCHLD), 0L, 0L, 0L, 0L) != -1) return "clone to a new world";
  if (syscall(SYS_unshare, (long)CLONE_NEWUSER) != -1) return "unshare";
  if (syscall(SYS_ptrace, 0L, 0L, 0L, 0L) != -1) return "ptrace";
  if (syscall(SYS_prlimit64, (long)getppid(), 7L, NULL, NULL) != -1) return "limits of others";
  if (kill(-1, 0) == 0 || kill(getppid(), 0) == 0 || kill(getpid(), 0) != 0) return "signals to others";
  if (syscall(SYS_tkill, (long)getppid(), 0L) != -1 || errno != EPERM) return "signals to threads";
  if (fcntl(100, F_GETFD) != -1) return "a file that its host's starter left open";
#ifdef __x86_64__
  if (syscall(0x40000000L + SYS_getpid) != -1 || errno != EPERM) return "x32";
#endif
  return NULL;
}

/* Where it hears of a signal. */
static int heard[2];

static void hear(int number) {
  (void)!write(heard[1], "!", 1);
  (void)number;
}

/* What a plugin must not do, in the middle of its work. */
static honami_code misdeed(const honami_call *call, const honami_frame *frame) {
  volatile int *nowhere = NULL;
  size_t gigabyte = (size_t)1 << 30;
  char *memory, place[4096];
  const uint8_t *past = frame->data + (frame->height - 1) * frame->stride + frame->width;
  int number = 0;
  switch (FAULT) {
    case SEGFAULT: case WITHERS: *nowhere = 1; break;
    case ABORTS: abort();
    case EXITS: exit(0);
    case LOOPS: for (;;) *(volatile uint64_t *)&(uint64_t){0} = 1;
    case SLEEPS: for (;;) sleep(1000);
    case DEAF: for (;;) call->progress(call, 0.5, "busy"), usleep(1000);
    case FLOODS: for (;;) puts("and on and on and on");
    case ESCAPES: puts("\033[2J\033[1;1H\033[31mred\033[0m\007"), fflush(stdout); break;
    case LEAKS:
      memory = malloc(gigabyte);
      if (!memory) return call->fail(call, HONAMI_E_MEMORY, "no memory for a gigabyte");
      memset(memory, 1, gigabyte);
      break;
    case FORKS: if (fork() == 0) for (;;) sleep(1000); else *nowhere = 1; break;
    case SOCKET: if (socket(AF_INET, SOCK_STREAM, 0) < 0) return call->fail(call, HONAMI_E_IO, "no socket"); break;
    case FILES: if (open("/etc/passwd", O_RDONLY) < 0) return call->fail(call, HONAMI_E_IO, "no file"); break;
    case READS_ON: for (int k = 0; k < 4096; k++) number += *(volatile const uint8_t *)(past + k); break;
    case WAITS:
      /* A signal comes to whichever thread does not block it, so that none may die of it: whoever hears it says so. */
      if (pipe(heard) != 0 || signal(SIGUSR1, hear) == SIG_ERR) return call->fail(call, HONAMI_E_IO, "no signals");
      prctl(PR_SET_NAME, "waits");
      puts("waits"), fflush(stdout);
      while (read(heard[0], &number, 1) < 0) continue;
      break;
    case CONNECTS: return call->fail(call, HONAMI_E_IO, connects() ? "a socket" : "no socket");
    case SCRIBBLES:
      snprintf(place, sizeof place, "%s/scribble", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
      return call->fail(call, HONAMI_E_IO, open(place, O_CREAT | O_WRONLY, 0600) < 0 ? "no room" : place);
    case CALLS: return call->fail(call, HONAMI_E_IO, calls() ? calls() : "none of the calls");
    case SPEAKS: fputs("read weights\nno weights for level 2", stderr), *nowhere = 1; break;
    default: break;
  }
  return HONAMI_OK;
}

static uint32_t ids[64];
static float xs[64], ys[64];
static uint64_t n_points;

static void destroy(honami_instance *instance) { free(instance); }

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  (void)instance, (void)values, (void)n;
  return FAULT == REFUSES_PARAMS ? call->fail(call, HONAMI_E_ARGUMENT, "not these") : HONAMI_OK;
}

static honami_code begin(honami_instance *instance, const honami_call *call, const honami_stream_info *stream) {
  (void)instance, (void)call, (void)stream;
  n_points = 0;
  return HONAMI_OK;
}

static honami_code seed(honami_instance *instance, const honami_call *call, const honami_table *points) {
  (void)instance;
  uint64_t n = n_points + points->rows < 64 ? points->rows : 64 - n_points;
  for (uint32_t c = 0; c < points->ncols; c++) {
    const honami_column *col = &points->cols[c];
    if (strcmp(col->name, "id") == 0) memcpy(ids + n_points, col->data, n * 4);
    if (strcmp(col->name, "x") == 0) memcpy(xs + n_points, col->data, n * 4);
    if (strcmp(col->name, "y") == 0) memcpy(ys + n_points, col->data, n * 4);
  }
  n_points += n;
  if (FAULT == SEED_RESULT) {
    honami_column col = {"id", HONAMI_U32, 1, NULL, 0};
    call->reserve(call, HONAMI_POINTS, 1, 1, &col);
  }
  return HONAMI_OK;
}

static honami_code retire(honami_instance *instance, const honami_call *call, const uint32_t *gone, uint64_t n) {
  (void)instance, (void)call, (void)gone, (void)n;
  return HONAMI_OK;
}

static honami_code push(honami_instance *instance, const honami_call *call, const honami_frame *frame) {
  enum fault fault = frame->index < FROM ? NONE : FAULT;
  honami_column c[5] = {{"id", HONAMI_U32, 1, NULL, 0}, {"x", HONAMI_F32, 1, NULL, 0}, {"y", HONAMI_F32, 1, NULL, 0},
                        {"status", fault == WRONG_TYPE ? HONAMI_F64 : HONAMI_U8, 1, NULL, 0},
                        {fault == BAD_QUALITY ? "fb" : "whatever", HONAMI_F32, 1, NULL, 0}};
  uint64_t rows = fault == TOO_MUCH ? UINT64_MAX : n_points;
  honami_code code;
  (void)instance;
  if ((frame->index == 2 || (fault == WITHERS && frame->index > 2)) && misdeed(call, frame) < 0) return HONAMI_E_FAILED;
  if (fault == NO_ROWS) return HONAMI_OK;
  if (fault == NEGATIVE) return call->fail(call, HONAMI_E_DATA, "the frame is too dark");
  if (fault == SILENT) return -77;
  if (fault == UNASKED_CANCEL) return HONAMI_E_CANCELLED;
  if (fault == AGAIN) return HONAMI_AGAIN;
  if (fault == COMMIT_ONLY) return call->commit(call, HONAMI_POINTS, n_points);
  if (fault == PRINTS) printf("printed by a plugin\n"), fflush(stdout);
  code = call->reserve(call, fault == OTHER_SCHEMA ? HONAMI_DENDROGRAM : HONAMI_POINTS, rows,
                       fault == MISSING_COLUMN ? 3 : 5, c);
  if (code < 0) return call->fail(call, code, "the host gives nothing");
  for (uint64_t i = 0; i < n_points; i++) {
    ((uint32_t *)c[0].data)[i] = ids[i];
    ((float *)c[1].data)[i] = xs[i];
    ((float *)c[2].data)[i] = ys[i];
    ((uint8_t *)c[3].data)[i] = i > 0 && frame->index >= HIDES ? HONAMI_OCCLUDED : HONAMI_TRACKED;
  }
  if (fault == NAN_POSITION) ((float *)c[2].data)[0] = NAN;
  if (fault == UNKNOWN_ID) ((uint32_t *)c[0].data)[0] = 999;
  if (fault == TWICE) ((uint32_t *)c[0].data)[1] = ids[0];
  if (fault == BAD_STATUS) ((uint8_t *)c[3].data)[0] = 6;
  if (fault == BAD_QUALITY) ((float *)c[4].data)[0] = -3;
  if (fault == PAST_THE_END) ((float *)c[1].data)[16] = 0;
  if (fault == COMMIT_RESERVE_COMMIT) {
    call->commit(call, HONAMI_POINTS, n_points);
    call->reserve(call, HONAMI_POINTS, n_points, 5, c);
  }
  if (fault == COMMIT_TWICE) call->commit(call, HONAMI_POINTS, n_points);
  return call->commit(call, HONAMI_POINTS, fault == OVERCOMMIT ? n_points + 1 : fault == FEWER ? 1 : n_points);
}

static honami_code end(honami_instance *instance, const honami_call *call) {
  (void)instance, (void)call;
  return HONAMI_OK;
}

static const honami_tracker_v1 tracker = {FAULT == SMALL_TABLE ? 16 : HONAMI_SIZE_TO(honami_tracker_v1, end),
                                          FAULT == OTHER_LATENCY ? 3 : 0, begin, seed, retire,
                                          FAULT == NULL_FUNCTION ? NULL : push, end};

static const void *get_interface(honami_instance *instance, const char *id) {
  (void)instance;
  if (FAULT == NULL_TABLE || strcmp(id, HONAMI_TRACKER) != 0) return NULL;
  return FAULT == SMALL_TABLE ? cut(&tracker, 16) : &tracker;
}

static honami_instance *create(const honami_host_info *host, const honami_call *call, const char *plugin_id) {
  honami_instance *self = (honami_instance *)calloc(1, sizeof(honami_instance));
  (void)host, (void)call, (void)plugin_id;
  if (FAULT == NO_INSTANCE || !self) return NULL;
  self->struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  self->destroy = destroy;
  self->set_params = set_params;
  self->get_interface = get_interface;
  if (FAULT == SMALL_INSTANCE) {
    self->struct_size = 16;
    return cut(self, 16);
  }
  return self;
}

#ifndef SYMBOL
#define SYMBOL honami_library_v1
#endif
HONAMI_EXPORT const honami_library *SYMBOL(const honami_host_info *host);
const honami_library *SYMBOL(const honami_host_info *host) {
  static const honami_library library = {FAULT == SMALL_RECORD ? 8 : HONAMI_SIZE_TO(honami_library, create), 0,
                                         FAULT == OTHER_MANIFEST ? "{}" : MANIFEST,
                                         FAULT == OTHER_MANIFEST ? 2 : sizeof(MANIFEST) - 1,
                                         FAULT == NULL_CREATE ? NULL : create};
  (void)host;
  if (FAULT == SMALL_RECORD) return cut(&library, 8);
  return FAULT == NULL_RECORD ? NULL : &library;
}
