/* loaded.c - a tracker with one fault of its file, of loading or of the ABI, chosen by -DFAULT=NAME. Without a fault it
 * leaves every point where it is. */
#define _GNU_SOURCE
#include "honami.h"
#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum fault {
  NONE,
  /* when it is loaded: */
  PRINTS, THREAD, OPENS, LOCALE, FLOATS, CHDIR, SETENV, SIGNAL, DIES, HANGS,
  /* when it is asked what it has: */
  OTHER_RECORD, ANY_ID, ANY_INTERFACE, LEAKS_FILES, OTHER_TABLE,
  /* at work: */
  READS_PAST, WRITES_TAIL, EXACT_SIZE, RESERVED, NEEDS_COLOUR, NEEDS_SERVICE, NEEDS_PARAMS, TRUSTS_RESERVE,
  HIDES_REFUSAL
};

#ifndef ID_TEXT
#define ID_TEXT "org.honami.bad"
#endif
#define MANIFEST                                                                                                    \
  "{\"honami\":1,\"abi\":[1,0],\"library\":{\"id\":\"org.honami.bad\",\"version\":\"0\",\"license\":\"MIT\"},"      \
  "\"plugins\":[{\"id\":\"" ID_TEXT "\",\"kind\":\"tracker\",\"name\":\"Bad\",\"doc\":\"Stays.\","                  \
  "\"interfaces\":[\"honami.tracker/1\"],\"caps\":{\"deterministic\":true},"                                        \
  "\"params\":[{\"id\":\"size\",\"type\":\"int\",\"default\":3,\"doc\":\"Does nothing.\"}]}]}"
HONAMI_MANIFEST(MANIFEST);

/* Seen by other libraries only when somebody forgets -fvisibility=hidden. */
int helper(void);
int helper(void) { return 1; }

#ifdef TEXTREL
__asm__(".text\n.quad helper\n");
#endif

static void *idle(void *nothing) {
  for (;;) sleep(1000);
  return nothing;
}

static void caught(int number) { (void)number; }

__attribute__((constructor)) static void before_all(void) {
  pthread_t thread;
  static int file;
  switch (FAULT) {
    case PRINTS: printf("hello\n"); break;
    case THREAD: pthread_create(&thread, NULL, idle, NULL); break;
    case OPENS: file = open("/dev/null", O_RDONLY); break;
    case LOCALE: setlocale(LC_ALL, "C.UTF-8"); break;
    case FLOATS: fesetround(FE_TOWARDZERO); break;
    case CHDIR: if (chdir("/usr") != 0) abort(); break;
    case SETENV: setenv("HONAMI_BAD", "1", 1); break;
    case SIGNAL: signal(SIGUSR1, caught); break;
    case DIES: abort();
    case HANGS: idle(NULL); break;
    default: break;
  }
  (void)file;
}

static uint32_t ids[64];
static float xs[64], ys[64];
static uint64_t n_points;

static void destroy(honami_instance *instance) { free(instance); }

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  (void)instance, (void)n;
  if (FAULT == NEEDS_PARAMS && strcmp(values[0].id, "size") != 0) return HONAMI_E_ARGUMENT;
  if (FAULT == RESERVED && (call->reserved != 0 || values[0].reserved != 0))
    return call->fail(call, HONAMI_E_ARGUMENT, "reserved is not zero");
  return HONAMI_OK;
}

static honami_code begin(honami_instance *instance, const honami_call *call, const honami_stream_info *stream) {
  (void)instance;
  n_points = 0;
  if (FAULT == EXACT_SIZE && stream->struct_size != sizeof(*stream))
    return call->fail(call, HONAMI_E_ARGUMENT, "a struct of another honami");
  return HONAMI_OK;
}

static honami_code seed(honami_instance *instance, const honami_call *call, const honami_table *points) {
  uint64_t n = points->rows < 64 ? points->rows : 64;
  (void)instance, (void)call;
  for (uint32_t c = 0; c < points->ncols; c++) {
    const honami_column *col = &points->cols[c];
    if (strcmp(col->name, "id") == 0) memcpy(ids, col->data, n * 4);
    if (strcmp(col->name, "x") == 0) memcpy(xs, col->data, n * 4);
    if (strcmp(col->name, "y") == 0) memcpy(ys, col->data, n * 4);
  }
  n_points = n;
  return HONAMI_OK;
}

static honami_code retire(honami_instance *instance, const honami_call *call, const uint32_t *gone, uint64_t n) {
  (void)instance, (void)call;
  for (uint64_t k = 0; k < n; k++)
    for (uint64_t i = 0; i < n_points; i++)
      if (ids[i] == gone[k]) n_points--, ids[i] = ids[n_points], xs[i] = xs[n_points], ys[i] = ys[n_points];
  return HONAMI_OK;
}

/* Reads what the compiler would leave out. */
static int seen(const uint8_t *byte) { return *(const volatile uint8_t *)byte; }

static honami_code push(honami_instance *instance, const honami_call *call, const honami_frame *frame) {
  honami_column c[4] = {{"id", HONAMI_U32, 1, NULL, 0}, {"x", HONAMI_F32, 1, NULL, 0}, {"y", HONAMI_F32, 1, NULL, 0},
                        {"status", HONAMI_U8, 1, NULL, 0}};
  honami_code code;
  (void)instance;
  if (FAULT == READS_PAST && seen((const uint8_t *)&frame->chroma_height) == 99) return HONAMI_E_FAILED;
  if (FAULT == WRITES_TAIL && frame->struct_size > sizeof(*frame)) memset((uint8_t *)frame + sizeof(*frame), 0, 4);
  if (FAULT == NEEDS_COLOUR && HONAMI_HAS(frame, honami_frame, chroma_height) && seen(frame->cb) == 1) return HONAMI_E_DATA;
  if (FAULT == NEEDS_SERVICE && seen((const uint8_t *)call->host_ext(call, "honami.gpu/1")) == 1) return HONAMI_E_DATA;
  code = call->reserve(call, HONAMI_POINTS, n_points, 4, c);
  if (code < 0 && FAULT == HIDES_REFUSAL) return HONAMI_OK;
  if (code < 0 && FAULT != TRUSTS_RESERVE) return call->fail(call, code, "the host gives nothing");
  for (uint64_t i = 0; i < n_points; i++) {
    ((uint32_t *)c[0].data)[i] = ids[i];
    ((float *)c[1].data)[i] = xs[i];
    ((float *)c[2].data)[i] = ys[i];
    ((uint8_t *)c[3].data)[i] = HONAMI_TRACKED;
  }
  return call->commit(call, HONAMI_POINTS, n_points);
}

static honami_code end(honami_instance *instance, const honami_call *call) {
  (void)instance, (void)call;
  return HONAMI_OK;
}

static const void *get_interface(honami_instance *instance, const char *id) {
  static honami_tracker_v1 tables[2];
  static int n_asked;
  const honami_tracker_v1 tracker = {HONAMI_SIZE_TO(honami_tracker_v1, end), 0, begin, seed, retire, push, end};
  (void)instance;
  if (FAULT != ANY_INTERFACE && strcmp(id, HONAMI_TRACKER) != 0) return NULL;
  n_asked++;
  tables[0] = tables[1] = tracker;
  return &tables[FAULT == OTHER_TABLE ? n_asked % 2 : 0];
}

static honami_instance *create(const honami_host_info *host, const honami_call *call, const char *plugin_id) {
  honami_instance *self;
  static int file;
  (void)host;
  if (FAULT != ANY_ID && strcmp(plugin_id, ID_TEXT) != 0) {
    call->fail(call, HONAMI_E_UNSUPPORTED, "no such plugin");
    return NULL;
  }
  if (FAULT == LEAKS_FILES) file = open("/dev/null", O_RDONLY);
  (void)file;
  self = (honami_instance *)calloc(1, sizeof(honami_instance));
  if (!self) return NULL;
  self->struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  self->destroy = destroy;
  self->set_params = set_params;
  self->get_interface = get_interface;
  return self;
}

const honami_library *honami_library_v1(const honami_host_info *host) {
  static honami_library records[2];
  static int n_asked;
  const honami_library record = {HONAMI_SIZE_TO(honami_library, create), 0, MANIFEST, sizeof(MANIFEST) - 1, create};
  (void)host;
  n_asked++;
  records[0] = records[1] = record;
  return &records[FAULT == OTHER_RECORD ? n_asked % 2 : 0];
}
