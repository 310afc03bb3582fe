/* template_tracker.c - a tracker in C that looks for every point's first picture of it, near where it was last.
 *
 *   cc -std=c99 -O2 -shared -fPIC -fvisibility=hidden -I../include template_tracker.c -lm -o template.so
 */
#include "honami.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MANIFEST                                                                                                      \
  "{\"honami\":1,\"abi\":[1,1],"                                                                                      \
  "\"library\":{\"id\":\"org.honami.template\",\"version\":\"1.0.0\",\"license\":\"MIT OR Apache-2.0\"},"             \
  "\"plugins\":[{\"id\":\"org.honami.template\",\"kind\":\"tracker\",\"name\":\"Templates of the first frame\","        \
  "\"doc\":\"Looks for the first picture of every point, near where it was last.\","                                  \
  "\"interfaces\":[\"honami.tracker/1\"],"                                                                            \
  "\"caps\":{\"latency\":0,\"deterministic\":true,\"parallel_instances\":true,\"pixels\":[\"gray8\"]},"               \
  "\"params\":[{\"id\":\"radius\",\"type\":\"int\",\"unit\":\"px\",\"min\":2,\"max\":30,\"default\":7,"                   \
  "\"doc\":\"Half the side of the template.\"},"                                                                      \
  "{\"id\":\"search\",\"type\":\"int\",\"unit\":\"px\",\"min\":1,\"max\":30,\"default\":6,"                               \
  "\"doc\":\"How far a point may move from frame to frame.\"}]}]}"
HONAMI_MANIFEST(MANIFEST);

/* A picture of the plugin's own, row by row. */
typedef struct picture { long width, height; uint8_t *pixels; } picture;
/* `first`: what is around it where it was seeded; NULL before the first frame, and near the border. */
typedef struct point { uint32_t id; float x, y; uint8_t *first; } point;
typedef struct tracker {
  honami_instance instance;
  long radius, search;
  int running;
  picture last; /* pixels are NULL before the first frame */
  point *points;
  uint64_t n, room;
} tracker;

static tracker *of(honami_instance *instance) { return (tracker *)instance->self; }

/* The first pixel of the window of radius r around the pixel nearest to (x, y); NULL where it leaves the picture. */
static const uint8_t *window(const picture *p, double x, double y, long r) {
  x = floor(x + 0.5) - (double)r;
  y = floor(y + 0.5) - (double)r;
  if (!(x >= 0 && y >= 0 && x + 2.0 * (double)r < (double)p->width && y + 2.0 * (double)r < (double)p->height)) return NULL;
  return p->pixels + (long)y * p->width + (long)x;
}

/* Keeps the template of a point, if there is one; 0 when there is no memory for it. */
static int keep(point *p, const picture *picture, long r) {
  const long side = 2 * r + 1;
  const uint8_t *from = window(picture, p->x, p->y, r);
  if (!from) return 1;
  p->first = (uint8_t *)malloc((size_t)(side * side));
  if (!p->first) return 0;
  for (long j = 0; j < side; j++) memcpy(p->first + j * side, from + j * picture->width, (size_t)side);
  return 1;
}

/* Whether what misses by so much is something else: by more than half of the template's own contrast. */
static int is_other(const uint8_t *first, long n, long miss) {
  long sum = 0, squares = 0;
  for (long k = 0; k < n; k++) sum += first[k], squares += (long)first[k] * first[k];
  return 2 * miss * n > n * squares - sum * sum;
}

/* Moves a point to where the sum of squared differences from its template is smallest; it stays where all look alike.
 * Where the search leaves the picture and finds something else, the point has left it, too. */
static uint8_t look(const tracker *self, const picture *now, point *p) {
  const long s = self->search, side = 2 * self->radius + 1;
  long best = LONG_MAX, dx = 0, dy = 0;
  for (long j = -s; p->first && j <= s; j++)
    for (long i = -s; i <= s; i++) {
      const uint8_t *here = window(now, p->x + (float)i, p->y + (float)j, self->radius);
      long miss = i || j;
      if (!here) continue;
      for (long y = 0; y < side; y++)
        for (long x = 0; x < side; x++) {
          const long d = (long)here[y * now->width + x] - (long)p->first[y * side + x];
          miss += d * d;
        }
      if (miss < best) best = miss, dx = i, dy = j;
    }
  if (best == LONG_MAX) return HONAMI_LOST;
  if (!window(now, p->x, p->y, self->radius + s) && is_other(p->first, side * side, best)) return HONAMI_LOST;
  p->x += (float)dx;
  p->y += (float)dy;
  return HONAMI_TRACKED;
}

static void forget(tracker *self, uint32_t id) {
  for (uint64_t i = 0; i < self->n; i++)
    if (self->points[i].id == id) {
      free(self->points[i].first);
      memmove(&self->points[i], &self->points[i + 1], (size_t)(self->n - i - 1) * sizeof(point));
      self->n--;
      return;
    }
}

static void stop(tracker *self) {
  for (uint64_t i = 0; i < self->n; i++) free(self->points[i].first);
  free(self->last.pixels);
  self->last.pixels = NULL;
  self->n = 0;
  self->running = 0;
}

static void destroy(honami_instance *instance) {
  stop(of(instance));
  free(of(instance)->points);
  free(of(instance));
}

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  if (of(instance)->running) return call->fail(call, HONAMI_E_STATE, "parameters are set before begin");
  of(instance)->radius = 7;
  of(instance)->search = 6;
  for (uint32_t i = 0; i < n; i++) {
    if (values[i].kind != HONAMI_INT) continue;
    if (strcmp(values[i].id, "radius") == 0) of(instance)->radius = (long)values[i].i;
    if (strcmp(values[i].id, "search") == 0) of(instance)->search = (long)values[i].i;
  }
  return HONAMI_OK;
}

static honami_code begin(honami_instance *instance, const honami_call *call, const honami_stream_info *stream) {
  if (stream->pixel != HONAMI_GRAY8) return call->fail(call, HONAMI_E_UNSUPPORTED, "only 8-bit gray frames");
  of(instance)->running = 1;
  return HONAMI_OK;
}

static const void *column(const honami_table *table, const char *name, uint32_t dtype) {
  for (uint32_t i = 0; i < table->ncols; i++)
    if (strcmp(table->cols[i].name, name) == 0 && table->cols[i].dtype == dtype) return table->cols[i].data;
  return NULL;
}

static honami_code seed(honami_instance *instance, const honami_call *call, const honami_table *table) {
  tracker *self = of(instance);
  const uint32_t *id = (const uint32_t *)column(table, "id", HONAMI_U32);
  const float *x = (const float *)column(table, "x", HONAMI_F32), *y = (const float *)column(table, "y", HONAMI_F32);
  if (!id || !x || !y) return call->fail(call, HONAMI_E_ARGUMENT, "seeds need id, x and y");
  for (uint64_t i = 0; i < table->rows; i++) {
    const point seeded = {id[i], x[i], y[i], NULL};
    forget(self, id[i]);
    if (self->n == self->room) {
      uint64_t room = self->room ? 2 * self->room : 64;
      point *points = (point *)realloc(self->points, (size_t)room * sizeof(point));
      if (!points) return call->fail(call, HONAMI_E_MEMORY, "no memory for the points");
      self->points = points;
      self->room = room;
    }
    self->points[self->n++] = seeded;
    if (self->last.pixels && !keep(&self->points[self->n - 1], &self->last, self->radius))
      return call->fail(call, HONAMI_E_MEMORY, "no memory for the templates");
  }
  return HONAMI_OK;
}

static honami_code retire(honami_instance *instance, const honami_call *call, const uint32_t *ids, uint64_t n) {
  (void)call;
  for (uint64_t i = 0; i < n; i++) forget(of(instance), ids[i]);
  return HONAMI_OK;
}

static honami_code push(honami_instance *instance, const honami_call *call, const honami_frame *frame) {
  tracker *self = of(instance);
  honami_column out[4] = {{"id", HONAMI_U32, 1, NULL, 0},
                          {"x", HONAMI_F32, 1, NULL, 0},
                          {"y", HONAMI_F32, 1, NULL, 0},
                          {"status", HONAMI_U8, 1, NULL, 0}};
  const int is_first = self->last.pixels == NULL;
  picture now = {(long)frame->width, (long)frame->height, NULL};
  honami_code code = call->reserve(call, HONAMI_POINTS, self->n, 4, out);
  if (code < 0) return code;
  now.pixels = (uint8_t *)realloc(self->last.pixels, (size_t)(now.width * now.height));
  if (!now.pixels) return call->fail(call, HONAMI_E_MEMORY, "no memory for a frame");
  self->last = now;
  for (long y = 0; y < now.height; y++)
    memcpy(now.pixels + y * now.width, frame->data + y * frame->stride, (size_t)now.width);
  for (uint64_t i = 0; i < self->n; i++) {
    point *p = &self->points[i];
    if (call->progress(call, (double)i / (double)self->n, "looking for templates")) {
      stop(self);
      return HONAMI_E_CANCELLED;
    }
    if (is_first && !keep(p, &now, self->radius)) return call->fail(call, HONAMI_E_MEMORY, "no memory for the templates");
    ((uint8_t *)out[3].data)[i] = look(self, &now, p);
    ((uint32_t *)out[0].data)[i] = p->id;
    ((float *)out[1].data)[i] = p->x;
    ((float *)out[2].data)[i] = p->y;
  }
  return call->commit(call, HONAMI_POINTS, self->n);
}

static honami_code end(honami_instance *instance, const honami_call *call) {
  (void)call;
  stop(of(instance));
  return HONAMI_OK;
}

static const honami_tracker_v1 interface = {HONAMI_SIZE_TO(honami_tracker_v1, end), 0, begin, seed, retire, push, end};

static const void *get_interface(honami_instance *instance, const char *id) {
  (void)instance;
  return strcmp(id, HONAMI_TRACKER) == 0 ? &interface : NULL;
}

static honami_instance *create(const honami_host_info *host, const honami_call *call, const char *plugin_id) {
  tracker *self;
  (void)host;
  if (strcmp(plugin_id, "org.honami.template") != 0) {
    call->fail(call, HONAMI_E_UNSUPPORTED, "no such plugin");
    return NULL;
  }
  self = (tracker *)calloc(1, sizeof(tracker));
  if (!self) return NULL;
  self->instance.struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  self->instance.self = self;
  self->instance.destroy = destroy;
  self->instance.set_params = set_params;
  self->instance.get_interface = get_interface;
  self->radius = 7;
  self->search = 6;
  return &self->instance;
}

const honami_library *honami_library_v1(const honami_host_info *host) {
  static const honami_library library = {HONAMI_SIZE_TO(honami_library, create), HONAMI_ABI_MINOR, honami_note.text,
                                         sizeof(MANIFEST) - 1, create};
  (void)host;
  return &library;
}
