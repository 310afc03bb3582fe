/* mortal.c - a tracker whose points gather speed, which positions alone do not tell: it saves and loads what it carries.
 * It dies in frame DIES once: not after load. By -DSAVING=... it is bad at that. */
#include "honami.h"
#include <stdlib.h>
#include <string.h>

#ifndef DIES
#define DIES -1
#endif
#ifndef VERSION
#define VERSION 1
#endif
enum { MAX = 64 };
enum saving { WELL, REFUSES_TO_SAVE, DIES_OF_SAVING, REFUSES_TO_LOAD };
#ifndef SAVING
#define SAVING WELL
#endif

#define MANIFEST                                                                                                     \
  "{\"honami\":1,\"abi\":[1,1],\"library\":{\"id\":\"org.honami.mortal\",\"version\":\"0\"},\"plugins\":[{"             \
  "\"id\":\"org.honami.mortal\",\"kind\":\"tracker\",\"name\":\"Mortal\",\"caps\":{\"deterministic\":true},"             \
  "\"interfaces\":[\"honami.tracker/1\",\"honami.state/1\"]}]}"
HONAMI_MANIFEST(MANIFEST);

/* What is saved: numbers of four bytes each, no padding. */
typedef struct carried {
  uint32_t version, sum, n_pushed, n;
  struct { uint32_t id; float x, y, speed; } points[MAX];
} carried;

typedef struct mortal {
  honami_instance base;
  carried now;
  int has_loaded;
} mortal;

static uint32_t sum_of(const carried *c) {
  carried copy = *c;
  uint32_t sum = 1;
  const unsigned char *bytes = (const unsigned char *)&copy;
  copy.sum = 0;
  for (size_t k = 0; k < sizeof copy; k++) sum = (sum ^ bytes[k]) * 16777619u;
  return sum;
}

static void destroy(honami_instance *instance) { free(instance); }

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  (void)instance, (void)call, (void)values, (void)n;
  return HONAMI_OK;
}

static honami_code begin(honami_instance *instance, const honami_call *call, const honami_stream_info *stream) {
  mortal *self = (mortal *)instance;
  (void)call, (void)stream;
  memset(&self->now, 0, sizeof self->now);
  self->has_loaded = 0;
  return HONAMI_OK;
}

static const void *column(const honami_table *table, const char *name) {
  for (uint32_t c = 0; c < table->ncols; c++)
    if (strcmp(table->cols[c].name, name) == 0) return table->cols[c].data;
  return NULL;
}

static honami_code seed(honami_instance *instance, const honami_call *call, const honami_table *points) {
  carried *now = &((mortal *)instance)->now;
  const uint32_t *id = (const uint32_t *)column(points, "id");
  const float *x = (const float *)column(points, "x"), *y = (const float *)column(points, "y");
  for (uint64_t k = 0; k < points->rows; k++) {
    uint32_t p = 0;
    while (p < now->n && now->points[p].id != id[k]) p++;
    if (p == MAX) return call->fail(call, HONAMI_E_DATA, "at most 64 points");
    if (p == now->n) now->n++;
    now->points[p].id = id[k], now->points[p].x = x[k], now->points[p].y = y[k], now->points[p].speed = 0;
  }
  return HONAMI_OK;
}

static honami_code retire(honami_instance *instance, const honami_call *call, const uint32_t *ids, uint64_t n) {
  carried *now = &((mortal *)instance)->now;
  (void)call;
  for (uint64_t k = 0; k < n; k++)
    for (uint32_t p = 0; p < now->n; p++)
      if (now->points[p].id == ids[k]) now->points[p] = now->points[--now->n];
  memset(now->points + now->n, 0, (MAX - now->n) * sizeof now->points[0]);
  return HONAMI_OK;
}

static honami_code push(honami_instance *instance, const honami_call *call, const honami_frame *frame) {
  mortal *self = (mortal *)instance;
  carried *now = &self->now;
  honami_column c[4] = {{"id", HONAMI_U32, 1, NULL, 0}, {"x", HONAMI_F32, 1, NULL, 0},
                        {"y", HONAMI_F32, 1, NULL, 0}, {"status", HONAMI_U8, 1, NULL, 0}};
  honami_code code = call->reserve(call, HONAMI_POINTS, now->n, 4, c);
  if (code < 0) return call->fail(call, code, "the host gives nothing");
  if (frame->index == DIES && !self->has_loaded) *(volatile int *)NULL = 1;
  for (uint32_t p = 0; p < now->n; p++) {
    if (now->n_pushed > 0) {
      now->points[p].speed += (float)frame->data[p % frame->width] / 1024;
      now->points[p].x += now->points[p].speed / 16;
    }
    ((uint32_t *)c[0].data)[p] = now->points[p].id;
    ((float *)c[1].data)[p] = now->points[p].x;
    ((float *)c[2].data)[p] = now->points[p].y;
    ((uint8_t *)c[3].data)[p] = HONAMI_TRACKED;
  }
  now->n_pushed++;
  return call->commit(call, HONAMI_POINTS, now->n);
}

static honami_code end(honami_instance *instance, const honami_call *call) {
  (void)instance, (void)call;
  return HONAMI_OK;
}

static honami_code save(honami_instance *instance, const honami_call *call) {
  carried *now = &((mortal *)instance)->now;
  honami_column c = {"bytes", HONAMI_U8, 1, NULL, 0};
  honami_code code;
  if (SAVING == REFUSES_TO_SAVE) return call->fail(call, HONAMI_E_FAILED, "it does not save");
  if (SAVING == DIES_OF_SAVING) *(volatile int *)NULL = 1;
  code = call->reserve(call, HONAMI_STATE, sizeof *now, 1, &c);
  if (code < 0) return call->fail(call, code, "the host gives nothing");
  now->version = VERSION;
  now->sum = sum_of(now);
  memcpy(c.data, now, sizeof *now);
  return call->commit(call, HONAMI_STATE, sizeof *now);
}

static honami_code load(honami_instance *instance, const honami_call *call, const uint8_t *bytes, uint64_t n) {
  mortal *self = (mortal *)instance;
  carried saved;
  if (SAVING == REFUSES_TO_LOAD) return call->fail(call, HONAMI_E_DATA, "it does not load");
  if (n != sizeof saved) return call->fail(call, HONAMI_E_DATA, "what was saved is cut");
  memcpy(&saved, bytes, sizeof saved);
  if (saved.version != VERSION) return call->fail(call, HONAMI_E_DATA, "what was saved is of another version");
  if (saved.sum != sum_of(&saved) || saved.n > MAX) return call->fail(call, HONAMI_E_DATA, "what was saved is damaged");
  self->now = saved;
  self->has_loaded = 1;
  return HONAMI_OK;
}

static const honami_tracker_v1 tracker = {HONAMI_SIZE_TO(honami_tracker_v1, end), 0, begin, seed, retire, push, end};
static const honami_state_v1 state = {HONAMI_SIZE_TO(honami_state_v1, load), 0, save, load};

static const void *get_interface(honami_instance *instance, const char *id) {
  (void)instance;
  if (strcmp(id, HONAMI_TRACKER) == 0) return &tracker;
  return strcmp(id, HONAMI_STATE) == 0 ? &state : NULL;
}

static honami_instance *create(const honami_host_info *host, const honami_call *call, const char *plugin_id) {
  mortal *self = (mortal *)calloc(1, sizeof(mortal));
  (void)host, (void)call, (void)plugin_id;
  if (!self) return NULL;
  self->base.struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  self->base.destroy = destroy;
  self->base.set_params = set_params;
  self->base.get_interface = get_interface;
  return &self->base;
}

const honami_library *honami_library_v1(const honami_host_info *host) {
  static const honami_library library = {HONAMI_SIZE_TO(honami_library, create), 1, MANIFEST, sizeof(MANIFEST) - 1,
                                         create};
  (void)host;
  return &library;
}
