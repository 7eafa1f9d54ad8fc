// Contact points of a substep, in a buffer that is reused.

const WIDTH = 14;

export class Rows {
  #numbers = new Float64Array(WIDTH << 10); // zeros, which the forces remain
  #length = 0;

  clear() {
    this.#length = 0;
  }

  /** Add a row: bodies a and b, the points on both [m], the unit normal from a to b, and a force of zero. */
  add(a, b, ax, ay, az, bx, by, bz, nx, ny, nz) {
    if (this.#length === this.#numbers.length) {
      const larger = new Float64Array(2 * this.#length);
      larger.set(this.#numbers);
      this.#numbers = larger;
    }
    const numbers = this.#numbers, k = this.#length; // number by number, because an array for each row takes longer
    numbers[k] = a;
    numbers[k + 1] = b;
    numbers[k + 2] = ax;
    numbers[k + 3] = ay;
    numbers[k + 4] = az;
    numbers[k + 5] = bx;
    numbers[k + 6] = by;
    numbers[k + 7] = bz;
    numbers[k + 8] = nx;
    numbers[k + 9] = ny;
    numbers[k + 10] = nz;
    this.#length += WIDTH;
  }

  numbers() {
    return this.#numbers.subarray(0, this.#length);
  }
}
