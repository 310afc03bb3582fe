/* tracker.c - Lucas and Kanade's tracker with one fault, chosen by -DFAULT=NAME; NONE is none. */
#define _GNU_SOURCE
#include "honami.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum fault {
  NONE,
  /* parameters */ NAN_AT_THE_END, INACTIVE, CHOICE, IN_BETWEEN, SECOND,
  /* frames */ READS_PAST, READS_BEFORE, READS_GAPS, DIES_OF_SMALL, DIES_OF_BLACK, DIES_OF_LONG, DIES_OF_LATE, DIES_OF_MANY,
  /* truth */ STAYS, DRIFTS, FORGETS, KEEPS_RETIRED, TRACKS_NOTHING,
  /* everywhere */ REACHES_OUT,
  /* running */ CLOCK, THREADS, ELSEWHERE, STATE, SHARED, SHARED_SMALL, FIRST_BESIDE, FALLS, DEAF, LEAKS_FILES, LEAKS_MEMORY
};

#if defined(WHEN_NOTHING)
#define MORE ",{\"id\":\"more\",\"type\":\"bool\",\"default\":false,\"when\":{\"nothing\":true},\"doc\":\"More.\"}"
#elif defined(NOW_NOTHING)
#define MORE ",{\"id\":\"old\",\"renamed_to\":\"nothing\"}"
#else
#define MORE ""
#endif

#define MANIFEST                                                                                                       \
  "{\"honami\":1,\"abi\":[1,0],"                                                                                       \
  "\"library\":{\"id\":\"org.honami.bad\",\"version\":\"1.0.0\",\"license\":\"MIT\"},"                                 \
  "\"plugins\":[{\"id\":\"org.honami.bad\",\"kind\":\"tracker\",\"name\":\"Bad\",\"doc\":\"Has a fault.\","            \
  "\"interfaces\":[\"honami.tracker/1\"],\"caps\":{\"deterministic\":true,\"parallel_instances\":true},\"params\":["   \
  "{\"id\":\"radius\",\"type\":\"int\",\"min\":2,\"max\":9,\"default\":5,\"doc\":\"Of the window.\"},"                 \
  "{\"id\":\"limit\",\"type\":\"bool\",\"default\":false,\"doc\":\"Loses what goes far.\"},"                           \
  "{\"id\":\"reach\",\"type\":\"float\",\"min\":0.001,\"max\":50,\"default\":10,\"when\":{\"limit\":true},"            \
  "\"doc\":\"How far.\"}" MORE "]}]}"
HONAMI_MANIFEST(MANIFEST);

typedef struct point { uint32_t id, status; float x, y; } point;
typedef struct bad {
  honami_instance instance;
  int radius, limit, width, height, n_frames, n_begun, n_threads;
  double reach;
  uint8_t *before;
  point *points;
  uint64_t n;
} bad;

static bad *of(honami_instance *instance) { return (bad *)instance->self; }

static void destroy(honami_instance *instance) {
  free(of(instance)->before);
  free(of(instance)->points);
  free(of(instance));
}

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  bad *self = of(instance);
  (void)call;
  self->radius = 5, self->limit = 0, self->reach = 10;
  for (uint32_t i = 0; i < n; i++) {
    if (strcmp(values[i].id, "radius") == 0) self->radius = (int)values[i].i;
    if (strcmp(values[i].id, "limit") == 0) self->limit = (int)values[i].i;
    if (strcmp(values[i].id, "reach") == 0) self->reach = values[i].f[0];
  }
  return HONAMI_OK;
}

static honami_code begin(honami_instance *instance, const honami_call *call, const honami_stream_info *stream) {
  if (FAULT == REACHES_OUT && socket(AF_UNIX, SOCK_STREAM, 0) >= 0) abort();
  bad *self = of(instance);
  free(self->before);
  self->before = (uint8_t *)malloc((size_t)stream->width * stream->height);
  if (!self->before) return call->fail(call, HONAMI_E_MEMORY, "no memory for a picture");
  self->width = (int)stream->width, self->height = (int)stream->height;
  self->n_threads = (int)stream->max_threads;
  self->n_frames = 0, self->n = 0, self->n_begun++;
  return HONAMI_OK;
}

static const void *column(const honami_table *table, const char *name) {
  for (uint32_t i = 0; i < table->ncols; i++)
    if (strcmp(table->cols[i].name, name) == 0) return table->cols[i].data;
  return NULL;
}

static void forget(bad *self, uint32_t id) {
  uint64_t kept = 0;
  for (uint64_t i = 0; i < self->n; i++)
    if (self->points[i].id != id) self->points[kept++] = self->points[i];
  self->n = kept;
}

static honami_code seed(honami_instance *instance, const honami_call *call, const honami_table *table) {
  bad *self = of(instance);
  const uint32_t *id = (const uint32_t *)column(table, "id");
  const float *x = (const float *)column(table, "x"), *y = (const float *)column(table, "y");
  point *points = (point *)realloc(self->points, (size_t)(self->n + table->rows + 1) * sizeof(point));
  if (!points) return call->fail(call, HONAMI_E_MEMORY, "no memory for the points");
  self->points = points;
  for (uint64_t i = 0; i < table->rows; i++) {
    if (self->n_frames > 0) forget(self, id[i]);
    point new = {id[i], HONAMI_TRACKED, x[i], y[i]};
    self->points[self->n++] = new;
  }
  return HONAMI_OK;
}

static honami_code retire(honami_instance *instance, const honami_call *call, const uint32_t *ids, uint64_t n) {
  (void)call;
  for (uint64_t i = 0; i < n && FAULT != KEEPS_RETIRED; i++) forget(of(instance), ids[i]);
  return HONAMI_OK;
}

/* Between four pixels; the border goes on for ever. */
static double at(const bad *self, const uint8_t *data, int64_t stride, double x, double y) {
  double fx = fmin(fmax(x, 0), self->width - 1), fy = fmin(fmax(y, 0), self->height - 1);
  int ix = (int)fx, iy = (int)fy;
  int jx = ix + 1 < self->width ? ix + 1 : ix, jy = iy + 1 < self->height ? iy + 1 : iy;
  const uint8_t *a = data + iy * stride, *b = data + jy * stride;
  fx -= ix, fy -= iy;
  return (1 - fy) * ((1 - fx) * a[ix] + fx * a[jx]) + fy * ((1 - fx) * b[ix] + fx * b[jx]);
}

/* Moves a point to where its window is now. */
static void follow(const bad *self, point *p, const honami_frame *frame) {
  int r = self->radius, w = self->width;
  double dx = 0, dy = 0, residual = 0;
  for (int iteration = 0; iteration < 10; iteration++) {
    double xx = 0, xy = 0, yy = 0, ex = 0, ey = 0;
    residual = 0;
    for (int i = -r; i <= r; i++)
      for (int j = -r; j <= r; j++) {
        double x = p->x + j, y = p->y + i;
        double gx = (at(self, self->before, w, x + 1, y) - at(self, self->before, w, x - 1, y)) / 2;
        double gy = (at(self, self->before, w, x, y + 1) - at(self, self->before, w, x, y - 1)) / 2;
        double e = at(self, self->before, w, x, y) - at(self, frame->data, frame->stride, x + dx, y + dy);
        xx += gx * gx, xy += gx * gy, yy += gy * gy, ex += e * gx, ey += e * gy, residual += fabs(e);
      }
    double det = xx * yy - xy * xy;
    if (det < 1) break;
    double sx = (yy * ex - xy * ey) / det, sy = (xx * ey - xy * ex) / det;
    dx += sx, dy += sy;
    if (sx * sx + sy * sy < 1e-4 || fabs(dx) + fabs(dy) > 20) break;
  }
  double x = p->x + dx, y = p->y + dy;
  double far = self->limit || FAULT == INACTIVE ? self->reach : 15;
  if (!(x >= r && y >= r && x <= self->width - 1 - r && y <= self->height - 1 - r)) p->status = HONAMI_OUTSIDE;
  else if (residual / ((2 * r + 1) * (2 * r + 1)) > 25 || hypot(dx, dy) > far) p->status = HONAMI_LOST;
  else p->x = (float)x, p->y = (float)y;
}

/* What a fault adds to where a point is. */
static float off(bad *self, const honami_frame *frame) {
  static bad *last;
  int is_shared = self->n_frames > 0 && last != self;
  last = self;
  if (FAULT == NAN_AT_THE_END && self->radius == 9) return NAN;
  if (FAULT == CHOICE && self->limit) return NAN;
  if (FAULT == IN_BETWEEN && self->radius == 4) return NAN;
  if (FAULT == SECOND && frame->width == 48) {
    static int n_streams;
    n_streams += self->n_frames == 0;
    return n_streams > 1 ? 0.01f : 0;
  }
  if (FAULT == DIES_OF_BLACK && frame->data[0] + frame->data[1] + frame->data[2] == 0) return *(volatile float *)NULL;
  if (FAULT == DIES_OF_LONG && frame->width > 4000) return *(volatile float *)NULL;
  if (FAULT == DIES_OF_LATE && frame->index > 1000) return *(volatile float *)NULL;
  if (FAULT == DIES_OF_MANY && frame->index == 60) return *(volatile float *)NULL;
  if (FAULT == CLOCK && frame->index == 7) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (float)(now.tv_nsec % 1000) * 1e-5f;
  }
  if (FAULT == READS_PAST) return (float)(frame->data[(frame->height - 1) * frame->stride + frame->width] & 1) * 1e-30f;
  if (FAULT == READS_BEFORE) return (float)(frame->data[-1] & 1) * 1e-30f;
  if (FAULT == READS_GAPS && frame->stride > frame->width) return frame->data[frame->width] * 1e-3f;
  if (FAULT == DIES_OF_SMALL && frame->width == 1) return *(volatile float *)NULL;
  if (FAULT == DRIFTS && self->n_frames > 0) return 0.1f;
  if (FAULT == THREADS && self->n_threads > 1) return 0.01f;
  if (FAULT == ELSEWHERE && strstr(program_invocation_short_name, "plughost")) return 0.01f;
  if (FAULT == STATE) return (float)(self->n_begun - 1) * 0.01f;
  if (FAULT == SHARED && is_shared) return 0.01f;
  if (FAULT == SHARED_SMALL && is_shared && self->width == 48) return 0.01f;
  if (FAULT == FIRST_BESIDE && gettid() != getpid()) {
    static bad *first;
    return __sync_bool_compare_and_swap(&first, NULL, self) || first == self ? 0.01f : 0;
  }
  if (FAULT == LEAKS_FILES) return (float)(open("/dev/null", O_RDONLY) < -1);
  if (FAULT == LEAKS_MEMORY) return (float)*(volatile char *)memset(malloc(16384), 0, 16384);
  return 0;
}

static honami_code push(honami_instance *instance, const honami_call *call, const honami_frame *frame) {
  bad *self = of(instance);
  honami_column out[4] = {{"id", HONAMI_U32, 1, NULL, 0}, {"x", HONAMI_F32, 1, NULL, 0},
                          {"y", HONAMI_F32, 1, NULL, 0}, {"status", HONAMI_U8, 1, NULL, 0}};
  float more = off(self, frame);
  uint64_t n = 0;
  for (uint64_t i = 0; i < self->n; i++) {
    point *p = &self->points[i];
    double done = (double)i / (double)self->n;
    if (i % 64 == 0 && call->progress(call, FAULT == FALLS ? 1 - done : done, "following") && FAULT != DEAF)
      return HONAMI_E_CANCELLED;
    if (self->n_frames > 0 && p->status == HONAMI_TRACKED && FAULT != STAYS) follow(self, p, frame);
    if (self->n_frames > 0 || FAULT == NAN_AT_THE_END) p->x += more;
  }
  if (FAULT == FORGETS && self->n_frames > 2) self->n /= 2;
  for (int y = 0; y < self->height; y++)
    memcpy(self->before + (size_t)y * (size_t)self->width, frame->data + y * frame->stride, (size_t)self->width);
  self->n_frames++;
  honami_code code = call->reserve(call, HONAMI_POINTS, self->n, 4, out);
  if (code < 0) return call->fail(call, code, "the host gives no memory");
  for (; n < self->n; n++) {
    ((uint32_t *)out[0].data)[n] = self->points[n].id;
    ((float *)out[1].data)[n] = self->points[n].x;
    ((float *)out[2].data)[n] = self->points[n].y;
    ((uint8_t *)out[3].data)[n] = (uint8_t)(FAULT == TRACKS_NOTHING ? HONAMI_TRACKED : self->points[n].status);
  }
  return call->commit(call, HONAMI_POINTS, n);
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
  bad *self;
  (void)host;
  if (strcmp(plugin_id, "org.honami.bad") != 0) {
    call->fail(call, HONAMI_E_UNSUPPORTED, "no such plugin");
    return NULL;
  }
  self = (bad *)calloc(1, sizeof(bad));
  if (!self) return NULL;
  self->radius = 5, self->reach = 10;
  self->instance.struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  self->instance.self = self;
  self->instance.destroy = destroy;
  self->instance.set_params = set_params;
  self->instance.get_interface = get_interface;
  return &self->instance;
}

HONAMI_EXPORT const honami_library *honami_library_v1(const honami_host_info *host) {
  static const honami_library library = {HONAMI_SIZE_TO(honami_library, create), HONAMI_ABI_MINOR, honami_note.text,
                                         sizeof(MANIFEST) - 1, create};
  (void)host;
  return &library;
}
