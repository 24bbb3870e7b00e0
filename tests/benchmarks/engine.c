/* Q-learning and algorithm 2 as plain loops that look at all eight actions at every step.
 *
 * cc -O3 -march=native -shared -fPIC; `engine.py` compiles and calls it.
 */
#include <stdint.h>
#include <string.h>

enum { MOVES = 8, CAPACITY = 10, LONGEST = 32 };

static const double ALPHA = 0.2, GAMMA = 0.7;

static uint64_t bits(uint64_t *word)
{
    uint64_t mixed = *word += 0x9E3779B97F4A7C15u;
    mixed = (mixed ^ mixed >> 30) * 0xBF58476D1CE4E5B9u;
    mixed = (mixed ^ mixed >> 27) * 0x94D049BB133111EBu;
    return mixed ^ mixed >> 31;
}

static double uniform(uint64_t *word) { return (bits(word) >> 11) * 0x1p-53; }

static int below(int high, uint64_t *word) { return (int)((bits(word) >> 32) * (uint64_t)high >> 32); }

static double best_value(const double *row)
{
    double best = row[0];
    for (int action = 1; action < MOVES; action++)
        if (row[action] > best)
            best = row[action];
    return best;
}

static int greedy(const double *row, uint64_t *word)
{
    int best[MOVES], count = 0;
    double value = best_value(row);
    for (int action = 0; action < MOVES; action++)
        if (row[action] == value)
            best[count++] = action;
    return count == 1 ? best[0] : best[below(count, word)];
}

static int epsilon_greedy(const double *row, double epsilon, uint64_t *word)
{
    return epsilon > uniform(word) ? below(MOVES, word) : greedy(row, word);
}

static double update(double *q, int state, int action, double reward, int entered)
{
    double *value = &q[state * MOVES + action];
    double change = ALPHA * (reward + GAMMA * best_value(&q[entered * MOVES]) - *value);
    *value += change;
    return change;
}

/* Returns how often the goal was reached. */
int64_t learn_alone(double *q, const int16_t *neighbours, int start, int goal, double epsilon, int64_t steps,
                    uint64_t seed)
{
    uint64_t word = seed;
    int state = start;
    int64_t arrivals = 0;
    for (int64_t step = 0; step < steps; step++) {
        int action = epsilon_greedy(&q[state * MOVES], epsilon, &word);
        int entered = neighbours[state * MOVES + action];
        update(q, state, action, entered == goal, entered);
        arrivals += entered == goal;
        state = entered == goal ? start : entered;
    }
    return arrivals;
}

struct path {
    int length, replicated, q_plus;
    int moves[LONGEST];
    double ratio;
};

static int choose_path(const struct path *paths, int count, uint64_t *word)
{
    double total = 0.0;
    for (int i = 0; i < count; i++)
        total += paths[i].ratio;
    double at = uniform(word) * total;
    for (int i = 0; i < count - 1; i++) {
        at -= paths[i].ratio;
        if (at < 0.0)
            return i;
    }
    return count - 1;
}

static void end_replay(struct path *path, double change)
{
    path->replicated++;
    path->q_plus += change > 0.0;
    path->ratio = (path->q_plus + 1.0) / (path->replicated + 1.0);
}

/* Approach 3 with `count` given paths of `length` moves; their final R_i go to `ratios`. */
int64_t learn_with_paths(double *q, const int16_t *neighbours, int start, int goal, double epsilon, double beta,
                         const int8_t *moves, int count, int length, double *ratios, int64_t steps, uint64_t seed)
{
    struct path paths[CAPACITY];
    for (int i = 0; i < count; i++) {
        paths[i] = (struct path){.length = length, .ratio = 1.0};
        for (int k = 0; k < length; k++)
            paths[i].moves[k] = moves[i * length + k];
    }
    uint64_t word = seed;
    int state = start, index = 0;
    struct path *path = 0;
    double replay_change = 0.0;
    int64_t arrivals = 0;
    for (int64_t step = 0; step < steps; step++) {
        double *row = &q[state * MOVES];
        int action, last = 0;
        if (path) {
            index++;
            last = index == path->length - 1;
        } else {
            path = &paths[choose_path(paths, count, &word)];
            if (beta * path->ratio > uniform(&word)) {
                index = 0;
                replay_change = 0.0;
            } else {
                path = 0;
            }
        }
        if (path && !last && best_value(row) > row[path->moves[index]]) {
            end_replay(path, replay_change);
            path = 0;
        }
        action = path ? path->moves[index] : epsilon_greedy(row, epsilon, &word);
        int entered = neighbours[state * MOVES + action];
        double change = update(q, state, action, entered == goal, entered);
        if (path) {
            replay_change += change;
            if (index == path->length - 1 || entered == goal || entered == state) {
                end_replay(path, replay_change);
                path = 0;
            }
        }
        arrivals += entered == goal;
        state = entered == goal ? start : entered;
    }
    for (int i = 0; i < count; i++)
        ratios[i] = paths[i].ratio;
    return arrivals;
}
