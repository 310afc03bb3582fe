/* template_structure.c - a structure builder in C: a bone from the root to the middle of every group.
 *
 *   cc -std=c99 -O2 -shared -fPIC -fvisibility=hidden -I../include template_structure.c -lm -o structure.so
 */
#include "honami.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MANIFEST                                                                                                      \
  "{\"honami\":1,\"abi\":[1,1],"                                                                                      \
  "\"library\":{\"id\":\"org.honami.fan\",\"version\":\"1.0.0\",\"license\":\"MIT OR Apache-2.0\"},"                  \
  "\"plugins\":[{\"id\":\"org.honami.fan\",\"kind\":\"structure\",\"name\":\"Fan\","                                  \
  "\"doc\":\"A bone from the root to the middle of every group.\","                                                   \
  "\"interfaces\":[\"honami.structure/1\"],\"caps\":{\"deterministic\":true,\"parallel_instances\":true},"            \
  "\"params\":[{\"id\":\"leaves\",\"type\":\"bool\",\"default\":true,\"label\":\"Leaves\","                           \
  "\"doc\":\"Whether every bone carries the tracks of its group.\"}]}]}"
HONAMI_MANIFEST(MANIFEST);

typedef struct builder {
  honami_instance instance;
  int has_leaves;
} builder;

/* Columns of what it is given, and what it works in. */
typedef struct work {
  const honami_call *call;
  const int64_t *frame, *frame0;         /* of times; of tracks */
  const uint32_t *len;                   /* samples of a track */
  const uint64_t *offset;                /* of its first sample */
  const float *x, *y;
  const uint8_t *status;
  const int32_t *parent, *group;         /* of groups; of tracks */
  uint64_t n_tracks, n_frames, n_groups;
  uint64_t n;                            /* joints so far; joint 0 is the root */
  int32_t *joint_of;                     /* group -> joint; 0: it has parts */
  double *middle;                        /* (n_groups + 1, n_frames, 2): of joints, pixels right and down */
  double *end;                           /* (n_groups + 1, n_frames, 2): where bones end */
} work;

static void destroy(honami_instance *instance) { free(instance->self); }

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  builder *self = (builder *)instance->self;
  (void)call;
  self->has_leaves = 1;
  for (uint32_t i = 0; i < n; i++)
    if (values[i].kind == HONAMI_BOOL && strcmp(values[i].id, "leaves") == 0) self->has_leaves = values[i].i != 0;
  return HONAMI_OK;
}

static const void *column(const honami_table *table, const char *name, uint32_t dtype) {
  for (uint32_t i = 0; i < table->ncols; i++)
    if (strcmp(table->cols[i].name, name) == 0 && table->cols[i].dtype == dtype) return table->cols[i].data;
  return NULL;
}

/* Whether a track is seen in a frame, and where. */
static int seen(const work *w, uint64_t track, uint64_t t, double at[2]) {
  const int64_t k = w->frame[t] - w->frame0[track];
  const uint64_t row = w->offset[track] + (uint64_t)k;
  if (k < 0 || k >= (int64_t)w->len[track]) return 0;
  if (w->status[row] != HONAMI_TRACKED && w->status[row] != HONAMI_NEWBORN) return 0;
  at[0] = (double)w->x[row], at[1] = (double)w->y[row];
  return 1;
}

/* The mean of a group's tracks, frame by frame; as in the frame before where none is seen, and at first as when one is.
 * 0 where none ever is. */
static int follow(const work *w, int32_t group, double (*middle)[2]) {
  uint64_t first = w->n_frames;
  for (uint64_t t = 0; t < w->n_frames; t++) {
    double sum[2] = {0, 0}, at[2], n = 0;
    for (uint64_t k = 0; k < w->n_tracks; k++)
      if (w->group[k] == group && seen(w, k, t, at)) sum[0] += at[0], sum[1] += at[1], n++;
    if (n > 0 && first == w->n_frames) first = t;
    if (n > 0) middle[t][0] = sum[0] / n, middle[t][1] = sum[1] / n;
    else if (first < t) memcpy(middle[t], middle[t - 1], sizeof middle[t]);
  }
  for (uint64_t t = 0; first < w->n_frames && t < first; t++) memcpy(middle[t], middle[first], sizeof middle[t]);
  return first < w->n_frames;
}

/* A joint for every group without parts, and where it is. */
static honami_code find(work *w) {
  w->n = 1;
  for (uint64_t g = 0; g < w->n_groups; g++) {
    int has_parts = 0;
    for (uint64_t k = 0; k < w->n_groups; k++) has_parts |= w->parent[k] == (int32_t)g;
    if (has_parts) continue;
    if (w->call->progress(w->call, (double)g / (double)w->n_groups, "following groups")) return HONAMI_E_CANCELLED;
    if (!follow(w, (int32_t)g, (double(*)[2])w->middle + w->n * w->n_frames))
      return w->call->fail(w->call, HONAMI_E_DATA, "a group is never seen");
    w->joint_of[g] = (int32_t)w->n++;
  }
  return HONAMI_OK;
}

static honami_code reserve(const work *w, const char *schema, uint64_t rows, uint32_t n, honami_column *cols) {
  const honami_code code = w->call->reserve(w->call, schema, rows, n, cols);
  return code < 0 ? w->call->fail(w->call, code, "the host gives no memory") : code;
}

/* The root, and bones from there: as long as its group is far in the mean, and pointed at it in every frame. */
static honami_code bones(work *w, const double root[2]) {
  honami_column joints[2] = {{"parent", HONAMI_I32, 1, NULL, 0}, {"length", HONAMI_F64, 1, NULL, 0}};
  honami_column base[3] = {{"x", HONAMI_F64, 1, NULL, 0}, {"y", HONAMI_F64, 1, NULL, 0}, {"z", HONAMI_F64, 1, NULL, 0}};
  honami_column pose = {"d", HONAMI_F64, 3, NULL, 0};
  honami_code code = reserve(w, HONAMI_JOINTS, w->n, 2, joints);
  if (code < 0 || (code = reserve(w, HONAMI_ROOT, 1, 3, base)) < 0) return code;
  if ((code = reserve(w, HONAMI_POSE, w->n * w->n_frames, 1, &pose)) < 0) return code;
  *(double *)base[0].data = root[0], *(double *)base[1].data = 0, *(double *)base[2].data = -root[1];
  for (uint64_t j = 0; j < w->n; j++) {
    double length = 0;
    for (uint64_t t = 0; j > 0 && t < w->n_frames; t++) {
      const double *at = w->middle + 2 * (j * w->n_frames + t);
      length += hypot(at[0] - root[0], at[1] - root[1]) / (double)w->n_frames;
    }
    if (j > 0 && !(length >= 1e-6)) return w->call->fail(w->call, HONAMI_E_DATA, "a group is where the root is");
    ((int32_t *)joints[0].data)[j] = j > 0 ? 0 : -1, ((double *)joints[1].data)[j] = length;
    for (uint64_t t = 0; t < w->n_frames; t++) {
      const double *at = w->middle + 2 * (j * w->n_frames + t);
      const double right = at[0] - root[0], up = root[1] - at[1], far = j > 0 ? hypot(right, up) : 0;
      double *d = (double *)pose.data + 3 * (t * w->n + j), *end = w->end + 2 * (j * w->n_frames + t);
      d[0] = far > 0 ? right / far : 0, d[1] = 0, d[2] = far > 0 ? up / far : 1;
      end[0] = root[0] + length * d[0], end[1] = root[1] - length * d[2];
    }
  }
  if ((code = w->call->commit(w->call, HONAMI_JOINTS, w->n)) < 0) return code;
  if ((code = w->call->commit(w->call, HONAMI_ROOT, 1)) < 0) return code;
  return w->call->commit(w->call, HONAMI_POSE, w->n * w->n_frames);
}

/* Which joint has become which group. */
static honami_code bears(const work *w) {
  honami_column cols[2] = {{"joint", HONAMI_U32, 1, NULL, 0}, {"group", HONAMI_U32, 1, NULL, 0}};
  const honami_code code = reserve(w, HONAMI_BEARS, w->n - 1, 2, cols);
  if (code < 0) return code;
  for (uint64_t g = 0; g < w->n_groups; g++) {
    const int32_t joint = w->joint_of[g];
    if (joint > 0) ((uint32_t *)cols[0].data)[joint - 1] = (uint32_t)joint, ((uint32_t *)cols[1].data)[joint - 1] = (uint32_t)g;
  }
  return w->call->commit(w->call, HONAMI_BEARS, w->n - 1);
}

/* What is left from the end of its bone to where a track is seen; where it is not, to the middle of its group. */
static honami_code leaves(const work *w) {
  honami_column rows[2] = {{"joint", HONAMI_U32, 1, NULL, 0}, {"track", HONAMI_U32, 1, NULL, 0}};
  honami_column offsets = {"d", HONAMI_F64, 3, NULL, 0};
  uint64_t n = 0;
  honami_code code = reserve(w, HONAMI_LEAVES, w->n_tracks, 2, rows);
  if (code < 0 || (code = reserve(w, HONAMI_OFFSETS, w->n_tracks * w->n_frames, 1, &offsets)) < 0) return code;
  for (uint64_t k = 0; k < w->n_tracks; k++) {
    if (w->group[k] < 0) continue;
    const uint64_t joint = (uint64_t)w->joint_of[w->group[k]];
    ((uint32_t *)rows[0].data)[n] = (uint32_t)joint, ((uint32_t *)rows[1].data)[n] = (uint32_t)k;
    for (uint64_t t = 0; t < w->n_frames; t++) {
      const uint64_t row = 2 * (joint * w->n_frames + t);
      double *d = (double *)offsets.data + 3 * (n * w->n_frames + t), at[2] = {w->middle[row], w->middle[row + 1]};
      (void)seen(w, k, t, at);
      d[0] = at[0] - w->end[row], d[1] = 0, d[2] = w->end[row + 1] - at[1];
    }
    n++;
  }
  if ((code = w->call->commit(w->call, HONAMI_LEAVES, n)) < 0) return code;
  return w->call->commit(w->call, HONAMI_OFFSETS, n * w->n_frames);
}

static honami_code grow(work *w, const double *given, int has_leaves) {
  double root[2] = {0, 0}, n = 0;
  honami_code code = find(w);
  if (code < 0) return code;
  /* Under the middle of all, as low as the lowest, where nobody has said. */
  for (uint64_t k = w->n_frames; k < w->n * w->n_frames; k++)
    root[0] += w->middle[2 * k], n++, root[1] = fmax(root[1], w->middle[2 * k + 1]);
  if (n > 0) root[0] /= n;
  if ((code = bones(w, given ? given : root)) < 0 || (code = bears(w)) < 0 || !has_leaves) return code;
  return leaves(w);
}

static honami_code run(honami_instance *instance, const honami_call *call, const honami_structure_input *input) {
  const honami_table *tracks = input->tracks, *groups = input->groups, *times = input->times;
  const size_t room = (size_t)(groups->rows + 1) * (size_t)times->rows + 1;
  honami_code code;
  work w = {0};
  w.call = call, w.n_tracks = tracks->rows, w.n_frames = times->rows, w.n_groups = groups->rows;
  w.frame = (const int64_t *)column(times, "frame", HONAMI_I64);
  w.frame0 = (const int64_t *)column(tracks, "frame0", HONAMI_I64);
  w.len = (const uint32_t *)column(tracks, "len", HONAMI_U32);
  w.offset = (const uint64_t *)column(tracks, "offset", HONAMI_U64);
  w.x = (const float *)column(tracks, "x", HONAMI_F32), w.y = (const float *)column(tracks, "y", HONAMI_F32);
  w.status = (const uint8_t *)column(tracks, "status", HONAMI_U8);
  w.parent = (const int32_t *)column(groups, "parent", HONAMI_I32);
  w.group = (const int32_t *)column(groups, "group", HONAMI_I32);
  if (!w.frame || !w.frame0 || !w.len || !w.offset || !w.x || !w.y || !w.status || !w.parent || !w.group)
    return call->fail(call, HONAMI_E_ARGUMENT, "tracks, times and groups have other columns");
  w.joint_of = (int32_t *)calloc((size_t)groups->rows + 1, sizeof(int32_t));
  w.middle = (double *)calloc(room, 2 * sizeof(double));
  w.end = (double *)calloc(room, 2 * sizeof(double));
  if (w.joint_of && w.middle && w.end) code = grow(&w, input->root, ((builder *)instance->self)->has_leaves);
  else code = call->fail(call, HONAMI_E_MEMORY, "no memory for the groups");
  free(w.joint_of), free(w.middle), free(w.end);
  return code;
}

static const honami_structure_v1 interface = {HONAMI_SIZE_TO(honami_structure_v1, run), 0, run};

static const void *get_interface(honami_instance *instance, const char *id) {
  (void)instance;
  return strcmp(id, HONAMI_STRUCTURE) == 0 ? &interface : NULL;
}

static honami_instance *create(const honami_host_info *host, const honami_call *call, const char *plugin_id) {
  builder *self;
  (void)host;
  if (strcmp(plugin_id, "org.honami.fan") != 0) {
    call->fail(call, HONAMI_E_UNSUPPORTED, "no such plugin");
    return NULL;
  }
  self = (builder *)calloc(1, sizeof(builder));
  if (!self) return NULL;
  self->instance.struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  self->instance.self = self;
  self->instance.destroy = destroy;
  self->instance.set_params = set_params;
  self->instance.get_interface = get_interface;
  self->has_leaves = 1;
  return &self->instance;
}

const honami_library *honami_library_v1(const honami_host_info *host) {
  static const honami_library library = {HONAMI_SIZE_TO(honami_library, create), HONAMI_ABI_MINOR, honami_note.text,
                                         sizeof(MANIFEST) - 1, create};
  (void)host;
  return &library;
}
