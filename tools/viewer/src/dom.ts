// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Elements made without markup: a text stays text, whatever is in it.

type Content = Node | string | null | undefined;

export function el<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Record<string, string> = {}, ...content: Content[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  for (const child of content) if (child !== null && child !== undefined) element.append(child);
  return element;
}

export function button(text: string, act: () => void, attributes: Record<string, string> = {}): HTMLButtonElement {
  const b = el("button", { type: "button", ...attributes }, text);
  b.addEventListener("click", act);
  return b;
}

export function select(label: string, options: [string, string][], act: (value: string) => void): HTMLLabelElement {
  const s = el("select", {}, ...options.map(([value, text]) => el("option", { value }, text)));
  s.addEventListener("change", () => act(s.value));
  return el("label", {}, label + " ", s);
}

export function toggle(label: string, on: boolean, act: (on: boolean) => void): HTMLLabelElement {
  const box = el("input", { type: "checkbox" });
  box.checked = on;
  box.addEventListener("change", () => act(box.checked));
  return el("label", {}, box, " " + label);
}
