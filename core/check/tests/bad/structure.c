/* structure.c - a bone from the root to every group without parts, with one fault, chosen by -DFAULT=NAME; NONE is none. */
#include "honami.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum fault { NONE, DIES_OF_ONE, DIES_OF_LOST, STILL, FIFTH, LEAVES_ONE_OUT, BARE_LEAVES, BY_ORDER, OWN_ROOT };

#define MANIFEST                                                                                                    \
  "{\"honami\":1,\"abi\":[1,1],"                                                                                    \
  "\"library\":{\"id\":\"org.honami.bad\",\"version\":\"1.0.0\",\"license\":\"MIT\"},"                              \
  "\"plugins\":[{\"id\":\"org.honami.bad\",\"kind\":\"structure\",\"name\":\"Bad\",\"doc\":\"Has a fault.\","       \
  "\"interfaces\":[\"honami.structure/1\"],\"caps\":{\"deterministic\":true,\"parallel_instances\":true}}]}"
HONAMI_MANIFEST(MANIFEST);

static void destroy(honami_instance *instance) { free(instance); }

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  (void)instance, (void)call, (void)values, (void)n;
  return HONAMI_OK;
}

static const void *column(const honami_table *table, const char *name, uint64_t *rows) {
  for (uint32_t i = 0; i < table->ncols; i++)
    if (strcmp(table->cols[i].name, name) == 0) {
      if (rows) *rows = table->cols[i].rows;
      return table->cols[i].data;
    }
  return NULL;
}

/* A sample of a track in a frame, or NULL where it is not seen. */
static const float *seen(const honami_structure_input *input, uint64_t track, uint64_t frame, float at[2]) {
  const honami_table *tracks = input->tracks;
  int64_t zero = ((const int64_t *)column(input->times, "frame", NULL))[0];
  int64_t k = zero + (int64_t)frame - ((const int64_t *)column(tracks, "frame0", NULL))[track];
  if (k < 0 || k >= ((const uint32_t *)column(tracks, "len", NULL))[track]) return NULL;
  uint64_t row = ((const uint64_t *)column(tracks, "offset", NULL))[track] + (uint64_t)k;
  if (((const uint8_t *)column(tracks, "status", NULL))[row] != HONAMI_TRACKED) return NULL;
  at[0] = ((const float *)column(tracks, "x", NULL))[row], at[1] = ((const float *)column(tracks, "y", NULL))[row];
  return at;
}

/* Where a group is in every frame; 0 when it is never seen. Where nothing of it is seen it stays. */
static int follow(const honami_structure_input *input, int32_t group, uint64_t n_frames, double (*centre)[2]) {
  uint64_t n_tracks, first = n_frames;
  const int32_t *of = (const int32_t *)column(input->groups, "group", &n_tracks);
  for (uint64_t t = 0; t < n_frames; t++) {
    double sum[2] = {0, 0}, n = 0;
    for (uint64_t track = 0; track < n_tracks; track++) {
      float at[2];
      if (of[track] != group || (FAULT == BY_ORDER && n > 0) || !seen(input, track, t, at)) continue;
      sum[0] += at[0], sum[1] += at[1], n++;
    }
    if (n > 0 && first == n_frames) first = t;
    for (int axis = 0; axis < 2; axis++) centre[t][axis] = n > 0 ? sum[axis] / n : t > 0 ? centre[t - 1][axis] : 0;
  }
  for (uint64_t t = 0; t < first && first < n_frames; t++) memcpy(centre[t], centre[first], sizeof centre[t]);
  if (FAULT == DIES_OF_LOST && first == n_frames) *(volatile int *)NULL = 1;
  return first < n_frames;
}

static honami_code reserve(const honami_call *call, const char *schema, uint64_t rows, uint32_t n, honami_column *cols) {
  honami_code code = call->reserve(call, schema, rows, n, cols);
  return code < 0 ? call->fail(call, code, "the host gives no memory") : code;
}

/* Leaves are where tracks are seen; where they are not, at their joint. */
static honami_code leaves(const honami_call *call, const honami_structure_input *input, const int32_t *joint_of,
                          const double (*places)[3], uint64_t n_joints, uint64_t n_frames) {
  honami_column rows[2] = {{"joint", HONAMI_U32, 1, NULL, 0}, {"track", HONAMI_U32, 1, NULL, 0}};
  honami_column offsets = {"d", HONAMI_F64, 3, NULL, 0};
  uint64_t n_tracks, n = 0;
  const int32_t *of = (const int32_t *)column(input->groups, "group", &n_tracks);
  honami_code code = reserve(call, HONAMI_LEAVES, n_tracks, 2, rows);
  if (code < 0 || (code = reserve(call, HONAMI_OFFSETS, n_tracks * n_frames, 1, &offsets)) < 0) return code;
  for (uint64_t track = 0; track < n_tracks; track++) {
    if (of[track] < 0) continue;
    uint32_t joint = (uint32_t)joint_of[of[track]];
    ((uint32_t *)rows[0].data)[n] = joint, ((uint32_t *)rows[1].data)[n] = (uint32_t)track;
    for (uint64_t t = 0; t < n_frames; t++) {
      double *d = (double *)offsets.data + 3 * (n * n_frames + t);
      float at[2];
      if (FAULT == BARE_LEAVES || !seen(input, track, t, at)) continue;
      d[0] = at[0] - places[t * n_joints + joint][0], d[2] = -at[1] - places[t * n_joints + joint][2];
    }
    n++;
  }
  if ((code = call->commit(call, HONAMI_LEAVES, n)) < 0) return code;
  return call->commit(call, HONAMI_OFFSETS, n * n_frames);
}

/* What it works in; joint k ends at group `group[k]`. */
typedef struct space { double (*centre)[2], (*places)[3]; int32_t *joint_of, *group; } space;

static honami_code grow(const honami_call *call, const honami_structure_input *input, space *in) {
  honami_column joints[2] = {{"parent", HONAMI_I32, 1, NULL, 0}, {"length", HONAMI_F64, 1, NULL, 0}};
  honami_column root[3] = {{"x", HONAMI_F64, 1, NULL, 0}, {"y", HONAMI_F64, 1, NULL, 0}, {"z", HONAMI_F64, 1, NULL, 0}};
  honami_column pose = {"d", HONAMI_F64, 3, NULL, 0};
  honami_column bears[2] = {{"joint", HONAMI_U32, 1, NULL, 0}, {"group", HONAMI_U32, 1, NULL, 0}};
  const uint64_t n_groups = input->groups->rows, n_frames = input->times->rows;
  const int32_t *parents = (const int32_t *)column(input->groups, "parent", NULL);
  uint64_t n = 1;
  double base[2] = {0, -1e9};
  for (uint64_t g = 0; g < n_groups; g++) {
    int is_whole = 1;
    for (uint64_t k = 0; k < n_groups; k++) is_whole = is_whole && parents[k] != (int32_t)g;
    if (!is_whole) continue;
    if (!follow(input, (int32_t)g, n_frames, in->centre + n * n_frames))
      return call->fail(call, HONAMI_E_DATA, "a group is never seen");
    for (uint64_t t = 0; t < n_frames; t++) base[1] = fmax(base[1], in->centre[n * n_frames + t][1]);
    in->joint_of[g] = (int32_t)n, in->group[n++] = (int32_t)g;
  }
  if (FAULT == DIES_OF_ONE && n == 2) *(volatile int *)NULL = 1;
  for (uint64_t k = 1; k < n; k++) base[0] += in->centre[k * n_frames][0] / (double)(n - 1);
  if (input->root && FAULT != OWN_ROOT) base[0] = input->root[0], base[1] = input->root[1];
  honami_code code = reserve(call, HONAMI_JOINTS, n, 2, joints);
  if (code < 0 || (code = reserve(call, HONAMI_ROOT, 1, 3, root)) < 0) return code;
  if ((code = reserve(call, HONAMI_POSE, n * n_frames, 1, &pose)) < 0) return code;
  if ((code = reserve(call, HONAMI_BEARS, n - 1, 2, bears)) < 0) return code;
  *(double *)root[0].data = base[0], *(double *)root[2].data = -base[1];
  ((int32_t *)joints[0].data)[0] = -1;
  for (uint64_t k = 1; k < n; k++) {
    double length = 0;
    for (uint64_t t = 0; t < n_frames; t++) {
      const double *at = in->centre[k * n_frames + t];
      length += hypot(at[0] - base[0], at[1] - base[1]) / (double)n_frames;
    }
    if (!(length > 1e-9)) return call->fail(call, HONAMI_E_DATA, "a group is where the root is");
    for (uint64_t t = 0; t < n_frames; t++) {
      const double *first = in->centre[k * n_frames], *at = in->centre[k * n_frames + t];
      const double part = FAULT == STILL ? 0 : FAULT == FIFTH ? 0.2 : 1;
      const double x = first[0] + part * (at[0] - first[0]) - base[0], z = base[1] - first[1] - part * (at[1] - first[1]);
      double *d = (double *)pose.data + 3 * (t * n + k), *place = in->places[t * n + k], far = hypot(x, z);
      d[0] = far > 0 ? x / far : 0, d[2] = far > 0 ? z / far : 1;
      place[0] = base[0] + length * d[0], place[2] = -base[1] + length * d[2];
    }
    ((double *)joints[1].data)[k] = length;
    ((uint32_t *)bears[0].data)[k - 1] = (uint32_t)k, ((uint32_t *)bears[1].data)[k - 1] = (uint32_t)in->group[k];
  }
  if ((code = call->commit(call, HONAMI_JOINTS, n)) < 0 || (code = call->commit(call, HONAMI_ROOT, 1)) < 0) return code;
  if ((code = call->commit(call, HONAMI_POSE, n * n_frames)) < 0) return code;
  if ((code = call->commit(call, HONAMI_BEARS, FAULT == LEAVES_ONE_OUT ? n - 2 : n - 1)) < 0) return code;
  return leaves(call, input, in->joint_of, (const double (*)[3])in->places, n, n_frames);
}

static honami_code run(honami_instance *instance, const honami_call *call, const honami_structure_input *input) {
  const uint64_t n_joints = input->groups->rows + 1, n = n_joints * input->times->rows;
  space in = {(double(*)[2])calloc(n, sizeof(double[2])), (double(*)[3])calloc(n, sizeof(double[3])),
              (int32_t *)calloc(n_joints, 4), (int32_t *)calloc(n_joints, 4)};
  honami_code code = HONAMI_E_CANCELLED;
  (void)instance;
  if (!in.centre || !in.places || !in.joint_of || !in.group) code = call->fail(call, HONAMI_E_MEMORY, "no memory");
  else if (!call->progress(call, 0, "growing")) code = grow(call, input, &in);
  free(in.centre), free(in.places), free(in.joint_of), free(in.group);
  return code;
}

static const honami_structure_v1 structure = {HONAMI_SIZE_TO(honami_structure_v1, run), 0, run};

static const void *get_interface(honami_instance *instance, const char *id) {
  (void)instance;
  return strcmp(id, HONAMI_STRUCTURE) == 0 ? &structure : NULL;
}

static honami_instance *create(const honami_host_info *host, const honami_call *call, const char *plugin_id) {
  honami_instance *self;
  (void)host;
  if (strcmp(plugin_id, "org.honami.bad") != 0) {
    call->fail(call, HONAMI_E_UNSUPPORTED, "no such plugin");
    return NULL;
  }
  self = (honami_instance *)calloc(1, sizeof(honami_instance));
  if (!self) return NULL;
  self->struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  self->destroy = destroy;
  self->set_params = set_params;
  self->get_interface = get_interface;
  return self;
}

HONAMI_EXPORT const honami_library *honami_library_v1(const honami_host_info *host) {
  static const honami_library library = {HONAMI_SIZE_TO(honami_library, create), HONAMI_ABI_MINOR, honami_note.text,
                                         sizeof(MANIFEST) - 1, create};
  (void)host;
  return &library;
}
