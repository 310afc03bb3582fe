/* null_tracker.c - a complete tracker in C: every point moves right by `drift` pixels in each frame.
 *
 *   cc -std=c99 -shared -fPIC -fvisibility=hidden -Iinclude examples/null_tracker.c -o honami-null.so
 */
#include "honami.h"
#include <stdlib.h>
#include <string.h>

#define MANIFEST                                                                                                      \
  "{\"honami\":1,\"abi\":[1,0],"                                                                                      \
  "\"library\":{\"id\":\"org.honami.examples\",\"version\":\"1.0.0\",\"license\":\"MIT OR Apache-2.0\"},"             \
  "\"plugins\":[{\"id\":\"org.honami.null\",\"kind\":\"tracker\",\"name\":\"Null\",\"doc\":\"x += drift\","           \
  "\"interfaces\":[\"honami.tracker/1\"],"                                                                            \
  "\"caps\":{\"latency\":0,\"deterministic\":true,\"parallel_instances\":true,\"pixels\":[\"gray8\"]},"               \
  "\"params\":[{\"id\":\"drift\",\"type\":\"float\",\"label\":\"Drift\",\"unit\":\"px/frame\",\"min\":-10,\"max\":10," \
  "\"default\":1,\"doc\":\"How far every point moves in a frame.\"}]}]}"
HONAMI_MANIFEST(MANIFEST);

typedef struct point { uint32_t id; float x, y; } point;
typedef struct null_tracker {
  honami_instance instance;
  double drift;
  int running, pushed;
  point *points;
  uint64_t n, room;
} null_tracker;

static null_tracker *of(honami_instance *instance) { return (null_tracker *)instance->self; }

static void destroy(honami_instance *instance) {
  free(of(instance)->points);
  free(of(instance));
}

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  if (of(instance)->running) return call->fail(call, HONAMI_E_STATE, "parameters are set before begin");
  of(instance)->drift = 1;
  for (uint32_t i = 0; i < n; i++)
    if (strcmp(values[i].id, "drift") == 0 && values[i].kind == HONAMI_FLOAT) of(instance)->drift = values[i].f[0];
  return HONAMI_OK;
}

static honami_code begin(honami_instance *instance, const honami_call *call, const honami_stream_info *stream) {
  if (stream->pixel != HONAMI_GRAY8) return call->fail(call, HONAMI_E_UNSUPPORTED, "only 8-bit gray frames");
  of(instance)->running = 1;
  of(instance)->pushed = 0;
  of(instance)->n = 0;
  return HONAMI_OK;
}

static const void *column(const honami_table *table, const char *name, uint32_t dtype) {
  for (uint32_t i = 0; i < table->ncols; i++)
    if (strcmp(table->cols[i].name, name) == 0 && table->cols[i].dtype == dtype) return table->cols[i].data;
  return NULL;
}

static void forget(null_tracker *self, uint32_t id) {
  for (uint64_t i = 0; i < self->n; i++)
    if (self->points[i].id == id) {
      memmove(&self->points[i], &self->points[i + 1], (size_t)(self->n - i - 1) * sizeof(point));
      self->n--;
      return;
    }
}

static honami_code seed(honami_instance *instance, const honami_call *call, const honami_table *table) {
  null_tracker *self = of(instance);
  const uint32_t *id = (const uint32_t *)column(table, "id", HONAMI_U32);
  const float *x = (const float *)column(table, "x", HONAMI_F32), *y = (const float *)column(table, "y", HONAMI_F32);
  if (!id || !x || !y) return call->fail(call, HONAMI_E_ARGUMENT, "seeds need id, x and y");
  for (uint64_t i = 0; i < table->rows; i++) {
    forget(self, id[i]);
    if (self->n == self->room) {
      uint64_t room = self->room ? 2 * self->room : 64;
      point *points = (point *)realloc(self->points, (size_t)room * sizeof(point));
      if (!points) return call->fail(call, HONAMI_E_MEMORY, "no memory for the points");
      self->points = points;
      self->room = room;
    }
    self->points[self->n].id = id[i];
    self->points[self->n].x = x[i];
    self->points[self->n++].y = y[i];
  }
  return HONAMI_OK;
}

static honami_code retire(honami_instance *instance, const honami_call *call, const uint32_t *ids, uint64_t n) {
  (void)call;
  for (uint64_t i = 0; i < n; i++) forget(of(instance), ids[i]);
  return HONAMI_OK;
}

static honami_code push(honami_instance *instance, const honami_call *call, const honami_frame *frame) {
  null_tracker *self = of(instance);
  honami_column out[4] = {{"id", HONAMI_U32, 1, NULL, 0},
                          {"x", HONAMI_F32, 1, NULL, 0},
                          {"y", HONAMI_F32, 1, NULL, 0},
                          {"status", HONAMI_U8, 1, NULL, 0}};
  honami_code code;
  if (call->progress(call, 0, "drifting")) {
    self->running = 0;
    return HONAMI_E_CANCELLED;
  }
  code = call->reserve(call, HONAMI_POINTS, self->n, 4, out);
  if (code < 0) return code;
  for (uint64_t i = 0; i < self->n; i++) {
    if (self->pushed) self->points[i].x += (float)self->drift;
    ((uint32_t *)out[0].data)[i] = self->points[i].id;
    ((float *)out[1].data)[i] = self->points[i].x;
    ((float *)out[2].data)[i] = self->points[i].y;
    ((uint8_t *)out[3].data)[i] =
        self->points[i].x >= -0.5f && self->points[i].x < (float)frame->width - 0.5f ? HONAMI_TRACKED : HONAMI_OUTSIDE;
  }
  self->pushed = 1;
  return call->commit(call, HONAMI_POINTS, self->n);
}

static honami_code end(honami_instance *instance, const honami_call *call) {
  (void)call;
  of(instance)->running = 0;
  return HONAMI_OK;
}

static const honami_tracker_v1 tracker = {HONAMI_SIZE_TO(honami_tracker_v1, end), 0, begin, seed, retire, push, end};

static const void *get_interface(honami_instance *instance, const char *id) {
  (void)instance;
  return strcmp(id, HONAMI_TRACKER) == 0 ? &tracker : NULL;
}

static honami_instance *create(const honami_host_info *host, const honami_call *call, const char *plugin_id) {
  null_tracker *self;
  (void)host;
  if (strcmp(plugin_id, "org.honami.null") != 0) {
    call->fail(call, HONAMI_E_UNSUPPORTED, "no such plugin");
    return NULL;
  }
  self = (null_tracker *)calloc(1, sizeof(null_tracker));
  if (!self) return NULL;
  self->instance.struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  self->instance.self = self;
  self->instance.destroy = destroy;
  self->instance.set_params = set_params;
  self->instance.get_interface = get_interface;
  self->drift = 1;
  return &self->instance;
}

const honami_library *honami_library_v1(const honami_host_info *host) {
  static const honami_library library = {HONAMI_SIZE_TO(honami_library, create), HONAMI_ABI_MINOR, honami_note.text,
                                         sizeof(MANIFEST) - 1, create};
  (void)host;
  return &library;
}
