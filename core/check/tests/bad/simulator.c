/* simulator.c - every node swings by itself, damped, pushed by the wind (symplectic Euler); with one fault, chosen by
 * -DFAULT=NAME; NONE is none. */
#include "honami.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum fault { NONE, DRIFTS, NEVER_CALMS, ONCE_A_CALL, KEEPS_SPEED, COARSE, FIRST_WIND, UNTURNED, IN_THE_WORLD,
             SKIPS_UNWANTED, FORGETS, DIES_OF_ONE };

#define MANIFEST                                                                                                    \
  "{\"honami\":1,\"abi\":[1,1],"                                                                                    \
  "\"library\":{\"id\":\"org.honami.bad\",\"version\":\"1.0.0\",\"license\":\"MIT\"},"                              \
  "\"plugins\":[{\"id\":\"org.honami.bad\",\"kind\":\"simulator\",\"name\":\"Bad\",\"doc\":\"Has a fault.\","       \
  "\"interfaces\":[\"honami.simulator/1\",\"honami.state/1\"],"                                                     \
  "\"caps\":{\"deterministic\":true,\"parallel_instances\":true}}]}"
HONAMI_MANIFEST(MANIFEST);

/* How a copy is turned, and how heavy it is. */
typedef struct copy { float yaw, mass; } copy;
/* A node of a copy: where it is and how fast. */
typedef struct node { double at[3], speed[3]; } node;

typedef struct plant {
  honami_instance base; /* first, so that the instance is the plant */
  uint64_t n_nodes, n_copies;
  copy *copies;
  node *nodes;
  double time_s;
} plant;

static void empty(plant *self) {
  free(self->copies), free(self->nodes);
  self->copies = NULL, self->nodes = NULL;
}

static void destroy(honami_instance *instance) {
  empty((plant *)instance);
  free(instance);
}

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  (void)instance, (void)call, (void)values, (void)n;
  return HONAMI_OK;
}

static const void *column(const honami_table *table, const char *name) {
  for (uint32_t i = 0; i < table->ncols; i++)
    if (strcmp(table->cols[i].name, name) == 0) return table->cols[i].data;
  return NULL;
}

static uint64_t rows(const honami_table *table, const char *name) {
  for (uint32_t i = 0; i < table->ncols; i++)
    if (strcmp(table->cols[i].name, name) == 0) return table->cols[i].rows;
  return 0;
}

static honami_code prepare(honami_instance *instance, const honami_call *call, const honami_simulator_input *input) {
  plant *self = (plant *)instance;
  empty(self);
  self->n_nodes = input->skeleton->rows, self->n_copies = input->instances ? input->instances->rows : 1;
  if (FAULT == DIES_OF_ONE && self->n_nodes == 1) *(volatile int *)NULL = 1;
  self->copies = (copy *)calloc(self->n_copies, sizeof(copy));
  self->nodes = (node *)calloc(self->n_nodes * self->n_copies, sizeof(node));
  self->time_s = 0;
  if (!self->copies || !self->nodes) return call->fail(call, HONAMI_E_MEMORY, "no memory for the plant");
  for (uint64_t k = 0; k < self->n_copies; k++) {
    self->copies[k].yaw = input->instances ? ((const float *)column(input->instances, "yaw"))[k] : 0;
    self->copies[k].mass = input->instances ? ((const float *)column(input->instances, "mass"))[k] : 1;
  }
  return HONAMI_OK;
}

static honami_code reset(honami_instance *instance, const honami_call *call) {
  plant *self = (plant *)instance;
  (void)call;
  if (!self->nodes) return call->fail(call, HONAMI_E_STATE, "no plant");
  if (FAULT == KEEPS_SPEED)
    for (uint64_t i = 0; i < self->n_nodes * self->n_copies; i++) memset(self->nodes[i].at, 0, sizeof self->nodes[i].at);
  else
    memset(self->nodes, 0, self->n_nodes * self->n_copies * sizeof(node));
  self->time_s = 0;
  return HONAMI_OK;
}

/* The wind at a copy now, turned into the copy's own axes. */
static void wind_at(const plant *self, const honami_table *wind, uint64_t k, double out[3]) {
  memset(out, 0, 3 * sizeof(double));
  if (!wind) return;
  const double *times = (const double *)column(wind, "time_s");
  const float *all = (const float *)column(wind, "wind");
  uint64_t n = wind->rows, each = rows(wind, "wind") / n, after = 0;
  while (after < n && times[after] <= self->time_s) after++;
  uint64_t a = after > 0 ? after - 1 : 0, b = after < n ? after : n - 1;
  double share = b > a ? (self->time_s - times[a]) / (times[b] - times[a]) : 0;
  uint64_t own = each > 1 && FAULT != FIRST_WIND ? k : 0;
  const float *from = all + 3 * (a * each + own), *to = all + 3 * (b * each + own);
  double w[3], yaw = FAULT == UNTURNED ? 0 : self->copies[k].yaw;
  for (int i = 0; i < 3; i++) w[i] = from[i] + share * (to[i] - from[i]);
  out[0] = cos(yaw) * w[0] + sin(yaw) * w[1], out[1] = cos(yaw) * w[1] - sin(yaw) * w[0], out[2] = w[2];
}

static void move(node *node, uint64_t k, const double wind[3], double mass, double dt) {
  /* The further out, the softer; along x softer than along y, so that it matters which way a copy is turned. */
  double stiffness = 400.0 / (1.0 + (double)k), damping = FAULT == NEVER_CALMS ? 0 : 1.2;
  for (int i = 0; i < 3; i++) {
    double push = (wind[i] + (FAULT == DRIFTS ? 1e-4 : 0)) / mass;
    double pull = stiffness * (1 + 0.5 * i) * node->at[i] + damping * node->speed[i];
    node->speed[i] += dt * (push - pull);
    node->at[i] += (FAULT == COARSE ? 1.0 / 240 : dt) * node->speed[i];
  }
}

/* As the plant is, whatever the copy's yaw and scale: who shows it turns and scales it. */
static void write_copy(const plant *self, uint64_t k, uint64_t n, float **out) {
  double yaw = FAULT == IN_THE_WORLD ? self->copies[k].yaw : 0;
  for (uint64_t i = 0; i < n; i++, *out += 3) {
    const double *at = self->nodes[k * self->n_nodes + i].at;
    (*out)[0] = (float)(cos(yaw) * at[0] - sin(yaw) * at[1]);
    (*out)[1] = (float)(sin(yaw) * at[0] + cos(yaw) * at[1]);
    (*out)[2] = (float)at[2];
  }
}

static honami_code step(honami_instance *instance, const honami_call *call, const honami_step_input *input) {
  plant *self = (plant *)instance;
  const uint32_t *wanted = input->detail ? (const uint32_t *)column(input->detail, "nodes") : NULL;
  honami_column out = {"d", HONAMI_F32, 3, NULL, 0};
  uint64_t n = 0;
  if (!self->nodes) return call->fail(call, HONAMI_E_STATE, "no plant");
  for (uint64_t k = 0; k < self->n_copies; k++) n += wanted ? wanted[k] : self->n_nodes;
  honami_code code = call->reserve(call, HONAMI_MOTION, n, 1, &out);
  if (code < 0) return call->fail(call, code, "the host gives no memory");
  for (uint32_t s = 0; s < input->n_steps; s++) {
    if (call->progress(call, s / (double)input->n_steps, "swinging")) { empty(self); return HONAMI_E_CANCELLED; }
    for (uint64_t k = 0; k < self->n_copies; k++) {
      double wind[3];
      wind_at(self, FAULT == ONCE_A_CALL && s > 0 ? NULL : input->wind, k, wind);
      if (FAULT == SKIPS_UNWANTED && wanted && wanted[k] == 0) continue;
      for (uint64_t i = 0; i < self->n_nodes; i++)
        move(&self->nodes[k * self->n_nodes + i], i, wind, self->copies[k].mass, input->dt);
    }
    self->time_s += input->dt;
  }
  float *place = (float *)out.data;
  for (uint64_t k = 0; k < self->n_copies; k++) write_copy(self, k, wanted ? wanted[k] : self->n_nodes, &place);
  return call->commit(call, HONAMI_MOTION, n);
}

static uint64_t sum(const uint8_t *bytes, uint64_t n) {
  uint64_t all = 1469598103934665603u;
  for (uint64_t i = 0; i < n; i++) all = (all ^ bytes[i]) * 1099511628211u;
  return all;
}

/* Saved: a sum of what follows, the time, the nodes. */
static honami_code save(honami_instance *instance, const honami_call *call) {
  plant *self = (plant *)instance;
  honami_column out = {"bytes", HONAMI_U8, 1, NULL, 0};
  if (!self->nodes) return call->fail(call, HONAMI_E_STATE, "no plant");
  uint64_t n = self->n_nodes * self->n_copies * sizeof(node);
  honami_code code = call->reserve(call, HONAMI_STATE, n + 16, 1, &out);
  if (code < 0) return call->fail(call, code, "the host gives no memory");
  uint8_t *bytes = (uint8_t *)out.data;
  memcpy(bytes + 8, FAULT == FORGETS ? &(double){0} : &self->time_s, 8);
  memcpy(bytes + 16, self->nodes, n);
  uint64_t check = sum(bytes + 8, n + 8);
  memcpy(bytes, &check, 8);
  return call->commit(call, HONAMI_STATE, n + 16);
}

static honami_code load(honami_instance *instance, const honami_call *call, const uint8_t *bytes, uint64_t n) {
  plant *self = (plant *)instance;
  if (!self->nodes) return call->fail(call, HONAMI_E_STATE, "no plant");
  uint64_t wanted = self->n_nodes * self->n_copies * sizeof(node), check;
  if (n != wanted + 16) return call->fail(call, HONAMI_E_DATA, "of another plant, or cut off");
  memcpy(&check, bytes, 8);
  if (check != sum(bytes + 8, n - 8)) return call->fail(call, HONAMI_E_DATA, "damaged");
  memcpy(&self->time_s, bytes + 8, 8);
  memcpy(self->nodes, bytes + 16, wanted);
  return HONAMI_OK;
}

static const honami_simulator_v1 simulator = {HONAMI_SIZE_TO(honami_simulator_v1, step), 0, prepare, reset, step};
static const honami_state_v1 state = {HONAMI_SIZE_TO(honami_state_v1, load), 0, save, load};

static const void *get_interface(honami_instance *instance, const char *id) {
  (void)instance;
  if (strcmp(id, HONAMI_STATE) == 0) return &state;
  return strcmp(id, HONAMI_SIMULATOR) == 0 ? &simulator : NULL;
}

static honami_instance *create(const honami_host_info *host, const honami_call *call, const char *plugin_id) {
  plant *self;
  (void)host;
  if (strcmp(plugin_id, "org.honami.bad") != 0) {
    call->fail(call, HONAMI_E_UNSUPPORTED, "no such plugin");
    return NULL;
  }
  self = (plant *)calloc(1, sizeof(plant));
  if (!self) return NULL;
  self->base.struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  self->base.destroy = destroy;
  self->base.set_params = set_params;
  self->base.get_interface = get_interface;
  return &self->base;
}

HONAMI_EXPORT const honami_library *honami_library_v1(const honami_host_info *host) {
  static const honami_library library = {HONAMI_SIZE_TO(honami_library, create), HONAMI_ABI_MINOR, honami_note.text,
                                         sizeof(MANIFEST) - 1, create};
  (void)host;
  return &library;
}
