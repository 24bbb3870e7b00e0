// A canvas that is as sharp as the screen, and drawn only when something has changed.

/** The context of a canvas in CSS pixels, cleared, with its width and height. */
export function prepared(canvas) {
  const ratio = devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const wanted = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== wanted[0] || canvas.height !== wanted[1]) [canvas.width, canvas.height] = wanted;
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

/** A line through points; nothing for fewer than two. */
export function line(context, points) {
  if (points.length < 2) return;
  context.beginPath();
  points.forEach(([x, y], at) => (at ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.stroke();
}

/** An arrow from one point to another. */
export function arrow(context, [fromX, fromY], [toX, toY], head) {
  const angle = Math.atan2(toY - fromY, toX - fromX);
  const neckX = toX - head * 0.8 * Math.cos(angle);
  const neckY = toY - head * 0.8 * Math.sin(angle);
  line(context, [[fromX, fromY], [neckX, neckY]]);
  context.beginPath();
  context.moveTo(toX, toY);
  for (const side of [-1, 1]) context.lineTo(toX - head * Math.cos(angle + side * 0.5), toY - head * Math.sin(angle + side * 0.5));
  context.closePath();
  context.fill();
}

/** Text with a rim of the background's colour, readable on anything. */
export function label(context, text, x, y, colour, rim) {
  context.lineWidth = 3.5;
  context.lineJoin = "round";
  context.strokeStyle = rim;
  context.strokeText(text, x, y);
  context.fillStyle = colour;
  context.fillText(text, x, y);
}
