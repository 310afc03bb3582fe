/* mine.c - a tracker whose points move right by FIRST pixels in the first frame and by STEP in every later one; before frame
 * WAIT it waits until somebody has opened
 * the pipe that it was given, and in frame DIES it dies. */
#include "honami.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef ID
#define ID "org.me.mine"
#endif
#ifndef GATE
#define GATE "path\",\"default\":\""
#endif
#define MANIFEST                                                                                       \
  "{\"honami\":1,\"abi\":[1,0],\"library\":{\"id\":\"org.me\",\"version\":\"" VERSION "\"},"          \
  "\"plugins\":[{\"id\":\"" ID "\",\"kind\":\"tracker\",\"name\":\"Mine\","                           \
  "\"interfaces\":[\"honami.tracker/1\"],\"params\":[{\"id\":\"gate\",\"type\":\"" GATE "\"}]}]}"
HONAMI_MANIFEST(MANIFEST);

static uint32_t ids[64];
static float xs[64], ys[64];
static uint64_t n_points;
static int has_pushed;
static char gate[4096];

static void destroy(honami_instance *instance) { free(instance); }

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  (void)instance, (void)call;
  for (uint32_t i = 0; i < n; i++)
    if (values[i].kind == HONAMI_TEXT) snprintf(gate, sizeof gate, "%s", values[i].text);
  return HONAMI_OK;
}

static honami_code begin(honami_instance *instance, const honami_call *call, const honami_stream_info *stream) {
  (void)instance, (void)call, (void)stream;
  n_points = 0, has_pushed = 0;
  return HONAMI_OK;
}

static honami_code seed(honami_instance *instance, const honami_call *call, const honami_table *points) {
  (void)instance, (void)call;
  for (uint32_t c = 0; c < points->ncols; c++) {
    const honami_column *col = &points->cols[c];
    if (strcmp(col->name, "id") == 0) memcpy(ids + n_points, col->data, points->rows * 4);
    if (strcmp(col->name, "x") == 0) memcpy(xs + n_points, col->data, points->rows * 4);
    if (strcmp(col->name, "y") == 0) memcpy(ys + n_points, col->data, points->rows * 4);
  }
  n_points += points->rows;
  return HONAMI_OK;
}

static honami_code retire(honami_instance *instance, const honami_call *call, const uint32_t *gone, uint64_t n) {
  (void)instance, (void)call, (void)gone, (void)n;
  return HONAMI_OK;
}

static honami_code push(honami_instance *instance, const honami_call *call, const honami_frame *frame) {
  honami_column c[4] = {{"id", HONAMI_U32, 1, NULL, 0}, {"x", HONAMI_F32, 1, NULL, 0},
                        {"y", HONAMI_F32, 1, NULL, 0}, {"status", HONAMI_U8, 1, NULL, 0}};
  (void)instance;
  if (frame->index == WAIT) {
    FILE *pipe = fopen(gate, "r");
    if (!pipe) return call->fail(call, HONAMI_E_IO, "no gate");
    while (fgetc(pipe) != EOF) continue;
    fclose(pipe);
  }
  if (frame->index >= DIES) abort();
  for (uint64_t i = 0; i < n_points; i++) xs[i] += has_pushed ? STEP : FIRST;
  has_pushed = 1;
  if (call->reserve(call, HONAMI_POINTS, n_points, 4, c) < 0) return HONAMI_E_MEMORY;
  memcpy(c[0].data, ids, n_points * 4);
  memcpy(c[1].data, xs, n_points * 4);
  memcpy(c[2].data, ys, n_points * 4);
  memset(c[3].data, HONAMI_TRACKED, n_points);
  return call->commit(call, HONAMI_POINTS, n_points);
}

static honami_code end(honami_instance *instance, const honami_call *call) {
  (void)instance, (void)call;
  return HONAMI_OK;
}

static const honami_tracker_v1 tracker = {HONAMI_SIZE_TO(honami_tracker_v1, end), 0, begin, seed, retire, push, end};

static const void *get_interface(honami_instance *instance, const char *id) {
  (void)instance;
  return strcmp(id, HONAMI_TRACKER) == 0 ? &tracker : NULL;
}

static honami_instance *create(const honami_host_info *host, const honami_call *call, const char *plugin_id) {
  honami_instance *instance = calloc(1, sizeof *instance);
  (void)host, (void)call, (void)plugin_id;
  if (!instance) return NULL;
  instance->struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  instance->destroy = destroy;
  instance->set_params = set_params;
  instance->get_interface = get_interface;
  return instance;
}

const honami_library *honami_library_v1(const honami_host_info *host) {
  static const honami_library library = {HONAMI_SIZE_TO(honami_library, create), HONAMI_ABI_MINOR, honami_note.text,
                                         sizeof(MANIFEST) - 1, create};
  (void)host;
  return &library;
}
